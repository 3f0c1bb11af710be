/* The Share button of a run or a comparison: a link to exactly what is on the screen, for somebody without an account. */
(function () {
  "use strict";
  const { ask, Field, Form, Once, draw, h } = window.slowdrift.people;

  /* What the page shows: its runs, and the choices that its address holds. */
  function shown() {
    const query = Object.fromEntries(new URLSearchParams(window.location.search));
    const found = /\/runs\/([A-Za-z0-9-]+)/.exec(window.location.pathname);
    const { runs, ...view } = query;
    return { run_ids: found ? [found[1]] : (runs || "").split(",").filter(Boolean), view };
  }

  function Dialog({ close }) {
    const { useState } = window.React;
    const [url, setUrl] = useState(null);
    const now = shown();
    const act = async ({ title, days }) => {
      const { ok, body, words } = await ask("POST", "/shares", { ...now, ...(title ? { title } : {}), expires_in_days: days ? Number(days) : null });
      if (ok) setUrl(new URL(new URL(body.url).pathname, window.location.origin).href);
      return words;
    };
    return h("div", { className: "sd-dialog" }, h("h2", null, "Share by link"),
      h("p", { className: "sd-hint" }, "Whoever has the link reads this, as it is on the screen, without an account. It changes nothing and can be revoked."),
      url ? h(Once, { words: "The link. It is shown this once.", text: url })
        : h(Form, { act, button: "Make a link", label: "Share" }, h(Field, { label: "Title", name: "title", required: false }),
          h(Field, { label: "Days", name: "days", type: "number", value: "30", required: false, hint: "empty: until it is revoked" })),
      h("button", { type: "button", className: "sd-small", onClick: close }, "Close"));
  }

  function share(clicks) {
    if (!clicks) return "";
    let dialog = document.getElementById("share-dialog");
    if (dialog) dialog.remove();
    dialog = document.createElement("dialog");
    Object.assign(dialog, { id: "share-dialog", className: "sd-share" });
    dialog.setAttribute("aria-label", "Share by link");
    document.body.appendChild(dialog);
    dialog.addEventListener("close", () => dialog.remove());
    draw("share-dialog", h(Dialog, { close: () => dialog.close() }));
    dialog.showModal();
    return "asked";
  }

  /* A shared page: what the link holds goes where an address would have it. */
  async function opened(token) {
    const keep = window.dash_clientside.no_update;
    if (!token) return keep;
    const { ok, body } = await ask("GET", `/shared/${encodeURIComponent(token)}`);
    if (!ok) return { missing: true };
    return { ...body, query: Object.fromEntries(new URLSearchParams(window.location.search)) };
  }

  Object.assign(window.dash_clientside.slowdrift, { share, opened, print: (clicks) => (clicks && window.print(), "") });
})();
