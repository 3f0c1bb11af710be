/* The YAML side of the editor: a coloured copy under the text area, line numbers with marks. */
(function () {
  "use strict";
  const { theCase, form } = window.slowdrift;
  /* Only while the page is there: a timer may fire, or an upload end, after the reader has left. */
  const set = theCase.set;
  const escape = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
  let loadedFor = null;
  let painted = "";

  /* One line of YAML in colours: comment, key, number. Never more than a hint. */
  function colour(line) {
    let comment = "";
    const at = line.search(/(^|\s)#/);
    if (at >= 0 && !/["'][^"']*#[^"']*["']/.test(line)) {
      comment = `<i>${escape(line.slice(at))}</i>`;
      line = line.slice(0, at);
    }
    const body = escape(line)
      .replace(/(^|[\s{,[-])([A-Za-z_][\w-]*)(?=:(\s|$))/g, "$1<b>$2</b>")
      .replace(/(^|[\s[(:,])(-?\d[\d_]*\.?\d*(?:[eE][-+]?\d+)?)(?=[\s,\]}]|$)/g, "$1<u>$2</u>");
    return body + comment;
  }

  function paint(text, marks) {
    const paper = document.getElementById("case-paint");
    const gutter = document.getElementById("case-gutter");
    if (!paper || !gutter) return;
    const wrong = new Map((marks || []).map((mark) => [mark.line, mark.message]));
    const lines = text.split("\n");
    paper.innerHTML = lines
      .map((line, i) => `<span class="${wrong.has(i + 1) ? "sd-line sd-line-wrong" : "sd-line"}">${colour(line) || " "}</span>`)
      .join("");
    gutter.innerHTML = lines
      .map((_, i) => {
        const message = wrong.get(i + 1);
        return message ? `<span class="sd-number-wrong" title="${escape(message).replace(/"/g, "&quot;")}">${i + 1}</span>` : `<span>${i + 1}</span>`;
      })
      .join("");
  }

  /* Called with each new text: from the keyboard, an example, a stored case, or the form. */
  function editor(text) {
    const area = document.getElementById("case-text");
    text = text || "";
    if (area && loadedFor !== area) {
      loadedFor = area;
      painted = "";
      const draft = theCase.open(/[?&](case|run)=/.test(window.location.search));
      form.mount();
      if (!text && draft) {
        set("case-text", { value: draft });
        return "draft";
      }
    }
    theCase.typed(text);
    repaint();
    return String(text.length);
  }

  function repaint() {
    const { text, errors, readError } = theCase.state;
    const marks = errors.filter((one) => one.line);
    if (readError && readError.line && !marks.length) marks.push(readError);
    const key = JSON.stringify([text, marks.map((one) => [one.line, one.message])]);
    if (key === painted || !document.getElementById("case-paint")) return;
    painted = key;
    paint(text, marks);
  }
  theCase.listen(repaint);

  function example(name, examples, text) {
    const keep = window.dash_clientside.no_update;
    if (!name || !examples || !(name in examples)) return [keep, keep];
    const own = (text || "").trim() && !Object.values(examples).includes(text);
    if (own && !window.confirm("Replace the text in the editor with this example?")) return [keep, null];
    return [examples[name], null];
  }

  function lineStart(text, line) {
    let at = 0;
    for (let i = 1; i < line; i += 1) {
      const next = text.indexOf("\n", at);
      if (next < 0) return at;
      at = next + 1;
    }
    return at;
  }

  function goTo(line, field) {
    const area = document.getElementById("case-text");
    if (!area || line < 1) return;
    const start = lineStart(area.value, line);
    const end = area.value.indexOf("\n", start) < 0 ? area.value.length : area.value.indexOf("\n", start);
    const key = (field || "").split(".").pop();
    const found = key ? area.value.slice(start, end).indexOf(`${key}:`) : -1;
    area.focus({ preventScroll: true });
    area.setSelectionRange(found >= 0 ? start + found : start, end);
    const box = document.getElementById("editor");
    const marked = document.getElementById("case-paint").children[line - 1];
    if (box && marked) box.scrollTo({ top: Math.max(0, marked.offsetTop - box.clientHeight / 3), left: 0 });
    if (box && box.getBoundingClientRect().top < 60) box.scrollIntoView({ block: "start" });
    else if (box && box.getBoundingClientRect().top > window.innerHeight - 120) box.scrollIntoView({ block: "center" });
  }

  document.addEventListener("keydown", (event) => {
    if (event.target.id !== "case-text" || event.key !== "Enter" || !(event.ctrlKey || event.metaKey)) return;
    event.preventDefault();
    document.getElementById("case-run").click();
  });

  /* A file goes from the browser straight to the REST API, however large. */
  function upload() {
    const input = document.createElement("input");
    input.type = "file";
    input.accept = ".nc,.h5,application/x-netcdf";
    input.id = "data-set-file";
    input.hidden = true;
    input.addEventListener("change", async () => {
      const file = input.files[0];
      input.remove();
      if (!file) return;
      const form = new FormData();
      form.append("file", file);
      form.append("name", file.name);
      set("data-set-upload", { loading: true });
      let told;
      try {
        const answer = await fetch("/api/v1/data-sets", { method: "POST", body: form, credentials: "same-origin" });
        const body = await answer.json();
        told = answer.ok ? body : { problem: body };
      } catch (error) {
        told = { problem: { title: "Not uploaded", detail: "The service does not answer. Try again." } };
      }
      set("data-set-upload", { loading: false });
      set("data-set-added", { data: { ...told, at: Date.now() } });
    });
    document.body.appendChild(input);
    input.click();
    return "asked";
  }

  window.slowdrift.yaml = { goTo };
  window.dash_clientside = window.dash_clientside || {};
  window.dash_clientside.slowdrift = Object.assign(window.dash_clientside.slowdrift || {}, { editor, example, upload });
})();
