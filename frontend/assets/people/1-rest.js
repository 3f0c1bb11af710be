/* What the pages of people share: questions to REST with their answers in words, forms, tables. */
(function () {
  "use strict";
  const API = "/api/v1";
  const prefix = () => JSON.parse(document.getElementById("_dash-config").textContent).requests_pathname_prefix;
  const h = (...args) => window.React.createElement(...args);

  async function ask(method, path, body) {
    let answer;
    try {
      answer = await fetch(API + path, { method, credentials: "same-origin", headers: body === undefined ? {} : { "content-type": "application/json" },
        body: body === undefined ? undefined : JSON.stringify(body) });
    } catch (error) {
      return { ok: false, status: 0, body: {}, words: "The service does not answer. Try again." };
    }
    const kind = answer.headers.get("content-type") || "";
    const found = kind.includes("json") ? await answer.json() : {};
    const faults = (found.errors || []).map((one) => `${one.field || ""} ${one.message}`.trim()).join(" ");
    const wait = answer.headers.get("retry-after");
    const words = answer.ok ? "" : [found.detail || found.title || `The service answered ${answer.status}.`, faults, wait ? `Try again in ${wait} s.` : ""].filter(Boolean).join(" ");
    return { ok: answer.ok, status: answer.status, body: found, words };
  }

  /* One labelled input of a form. */
  const Field = ({ label, name, type, auto, value, hint, required }) => h("label", { className: "sd-form-field" }, h("span", null, label),
    h("input", { className: "sd-input", name, type: type || "text", autoComplete: auto || "off", defaultValue: value || "", required: required !== false }),
    hint ? h("small", null, hint) : null);

  const Select = ({ label, name, options, value }) => h("label", { className: "sd-form-field" }, h("span", null, label),
    h("select", { className: "sd-input", name, defaultValue: value }, options.map(([key, words]) => h("option", { key, value: key }, words))));

  /* A form that sends its fields to `act` and shows what was said. */
  function Form({ act, button, children, label }) {
    const { useState } = window.React;
    const [said, setSaid] = useState("");
    const [busy, setBusy] = useState(false);
    const send = async (event) => {
      event.preventDefault();
      const form = event.target;
      setBusy(true);
      setSaid((await act(Object.fromEntries(new FormData(form).entries()), form)) || "");
      setBusy(false);
    };
    return h("form", { onSubmit: send, className: "sd-people-form", "aria-label": label }, children,
      h("button", { className: "sd-button sd-button-filled", disabled: busy, type: "submit" }, button),
      h("p", { className: "sd-field-wrong", role: "alert" }, said));
  }

  function Table({ head, rows, label }) {
    return h("div", { className: "sd-scroll", tabIndex: 0, role: "region", "aria-label": label },
      h("table", { className: "sd-plain-table" }, h("thead", null, h("tr", null, head.map((one, i) => h("th", { key: i, scope: "col" }, one)))),
        h("tbody", null, rows.map((row, i) => h("tr", { key: i }, row.map((cell, j) => h("td", { key: j }, cell)))))));
  }

  /* Something shown once, to be copied. */
  function Once({ words, text }) {
    const { useState } = window.React;
    const [done, setDone] = useState(false);
    const copy = async () => { try { await navigator.clipboard.writeText(text); setDone(true); } catch (error) { setDone(false); } };
    return h("div", { className: "sd-box sd-box-good", role: "status" }, h("strong", null, words),
      h("p", { className: "sd-once" }, h("input", { className: "sd-input", readOnly: true, value: text, "aria-label": words, onFocus: (event) => event.target.select() }),
        h("button", { type: "button", className: "sd-small", onClick: copy }, done ? "Copied" : "Copy")));
  }

  const day = (text) => (text ? text.slice(0, 10) : "never");
  const roots = new WeakMap();
  /* Draw a React element into an element of the page, once per element. */
  function draw(id, element) {
    const host = document.getElementById(id);
    if (!host) return;
    if (!roots.has(host)) roots.set(host, window.ReactDOM.createRoot(host));
    roots.get(host).render(element);
  }

  window.slowdrift.people = { ask, Field, Select, Form, Table, Once, day, draw, h, prefix };
})();
