/* Files into the editor: a MoorDyn deck becomes the text of a case; the vessel, sea and analyses already there stay. */
(function () {
  "use strict";
  const { theCase } = window.slowdrift;
  const MOST = 1_000_000;

  async function read(file) {
    if (file.size > MOST) return { problem: { title: "The deck is too large", detail: `${file.size} bytes; allowed: at most ${MOST}` } };
    const body = { deck: await file.text(), name: file.name.replace(/\.[^.]*$/, "") };
    const { tree, text } = theCase.state;
    if (tree && tree.vessel) body.case = text;
    try {
      const { ok, body: said } = await theCase.ask(`${theCase.API}/imports/moordyn`, JSON.stringify(body));
      return ok ? said : { problem: said };
    } catch (error) {
      return { problem: { title: "Not read", detail: "The service does not answer. Try again." } };
    }
  }

  function importDeck(clicks) {
    if (!clicks) return "";
    const input = document.createElement("input");
    Object.assign(input, { type: "file", accept: ".dat,.txt,.inp,text/plain", id: "deck-file", hidden: true });
    input.addEventListener("change", async () => {
      const file = input.files[0];
      input.remove();
      if (!file) return;
      const said = await read(file);
      const text = theCase.state.text.trim();
      if (said.yaml && (!text || window.confirm("Replace the case in the editor with the deck's lines? Its vessel, sea and analyses stay."))) {
        theCase.set("case-text", { value: said.yaml });
        theCase.set("deck-read", { data: said });
      } else if (said.problem) theCase.set("deck-read", { data: said });
    });
    document.body.appendChild(input);
    input.click();
    return "asked";
  }

  Object.assign(window.dash_clientside.slowdrift, { importDeck });
})();
