/* The form as a whole: sections as tabs, each with its number of faults; mounted into the page's #case-form. */
(function () {
  "use strict";
  const { theCase, schema: S, fields: F, parts: P, rigging: R } = window.slowdrift;
  const { h } = F;
  const model = (name) => S.resolve({ $ref: `#/$defs/${name}` });
  const only = (names) => (loc) => names.includes(String(loc[0]));
  const START = { mass: "10000 t", centre_of_gravity: ["0", "0", "0"], radii_of_gyration: ["10 m", "25 m", "25 m"] };
  let shownSection = "sea";

  const SECTIONS = [
    { key: "sea", words: "Sea", mine: only(["name", "description", "environment", "slowdrift"]),
      draw: (tree) => h("div", null,
        h(P.Part, { path: [], schema: { ...theCase.state.schema, model: "Case" }, value: tree, only: ["name", "description"] }),
        h(P.Part, { path: ["environment"], schema: model("Environment"), value: tree.environment })) },
    { key: "vessel", words: "Vessel", mine: only(["vessel"]), draw: (tree) => h(Vessel, { tree }) },
    { key: "types", words: "Line types", mine: only(["line_types"]), draw: (tree) => h(R.LineTypes, { tree }) },
    { key: "lines", words: "Lines", mine: only(["lines"]), draw: (tree) => h(R.Lines, { tree }) },
    { key: "attachments", words: "Attachments", mine: only(["attachments"]), draw: (tree) => h(R.Attachments, { tree }) },
    { key: "analyses", words: "Analyses", mine: only(["analyses"]), draw: (tree) => h(Analyses, { tree }) },
  ];

  function Vessel({ tree }) {
    const add = () => {
      const data = theCase.state.dataSets[0];
      F.set(["vessel"], { ...START, ...(data ? { hydrodynamics: { data: data.name } } : { hydrostatics: {} }) });
    };
    if (!tree.vessel) {
      return h("div", null, h("p", { className: "sd-hint" }, S.help(theCase.state.schema.properties.vessel)),
        h("button", { type: "button", className: "sd-small", onClick: add }, "Add a vessel"));
    }
    return h("div", null, h(P.Part, { path: ["vessel"], schema: model("Vessel"), value: tree.vessel }),
      h("button", { type: "button", className: "sd-small sd-plain", onClick: () => F.remove(["vessel"]) }, "Remove the vessel"));
  }

  function Analyses({ tree }) {
    const schema = model("Analyses");
    const asked = tree.analyses || {};
    return h("div", null, h(F.Faults, { path: ["analyses"] }),
      Object.entries(schema.properties).map(([name, raw]) => {
        const path = ["analyses", name];
        const on = asked[name] !== undefined && asked[name] !== null;
        const found = S.resolve(raw);
        return h("div", { key: name, className: "sd-card" },
          h("div", { className: "sd-field-switch" },
            h("input", { type: "checkbox", id: F.idOf(path), checked: on, onChange: (event) => (event.target.checked ? F.set(path, {}) : F.remove(path)) }),
            h("label", { htmlFor: F.idOf(path) }, h("strong", null, S.label(name))),
            h(F.Help, { id: `${F.idOf(path)}-help`, text: found.description, what: S.label(name) })),
          on ? h(P.Part, { path, schema: found, value: asked[name] }) : null);
      }));
  }

  const Lists = ({ tree }) => h(window.React.Fragment, null,
    h("datalist", { id: "sd-data-sets" }, theCase.state.dataSets.map((one) => h("option", { key: one.id, value: one.name }))),
    h("datalist", { id: "sd-line-types" }, Object.keys(tree.line_types || {}).map((name) => h("option", { key: name, value: name }))),
    h("datalist", { id: "sd-lines" }, Object.keys(tree.lines || {}).map((name) => h("option", { key: name, value: name }))));

  function Form() {
    const { useReducer, useEffect, useState } = window.React;
    const [, redraw] = useReducer((n) => n + 1, 0);
    const [section, setSection] = useState(shownSection);
    useEffect(() => theCase.listen(redraw), []);
    useEffect(() => {
      const jump = (event) => { shownSection = event.detail; setSection(event.detail); };
      window.addEventListener("slowdrift:section", jump);
      return () => window.removeEventListener("slowdrift:section", jump);
    }, []);
    const { state } = theCase;
    if (!state.schema) return h("p", { className: "sd-hint" }, "Reading the schema …");
    const choose = (key) => { shownSection = key; setSection(key); };
    const now = SECTIONS.find((one) => one.key === section) || SECTIONS[0];
    const keys = (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!step) return;
      const next = SECTIONS[(SECTIONS.indexOf(now) + step + SECTIONS.length) % SECTIONS.length];
      choose(next.key);
      document.getElementById(`tab-${next.key}`).focus();
    };
    const tab = ({ key, words, mine }) => {
      const count = state.errors.filter((one) => mine(one.loc || [])).length;
      return h("button", { key, id: `tab-${key}`, type: "button", role: "tab", "aria-selected": key === now.key, "aria-controls": "form-section", tabIndex: key === now.key ? 0 : -1,
        className: "sd-section-tab", onClick: () => choose(key), onKeyDown: keys },
        words, count ? h("span", { className: "sd-count", "aria-label": `${count} to mend` }, count) : null);
    };
    return h("div", { className: "sd-form" },
      h("div", { role: "tablist", "aria-label": "Parts of the case", className: "sd-section-tabs" }, SECTIONS.map(tab)),
      state.readError ? h("p", { className: "sd-field-wrong", role: "status" }, `The form waits: ${state.readError.line ? `line ${state.readError.line}: ` : ""}${state.readError.message}`) : null,
      state.refused ? h("p", { className: "sd-field-wrong", role: "alert" }, state.refused) : null,
      h(Lists, { tree: state.tree || {} }),
      h("div", { role: "tabpanel", id: "form-section", "aria-labelledby": `tab-${now.key}`, tabIndex: -1, className: "sd-section" }, now.draw(state.tree || {})));
  }

  /* Where a fault is, in the form: its section, then its field. */
  function section(loc) {
    const found = SECTIONS.find((one) => one.mine(loc));
    if (found) window.dispatchEvent(new CustomEvent("slowdrift:section", { detail: found.key }));
  }

  function show(loc) {
    section(loc);
    setTimeout(() => {
      for (let cut = loc.length; cut > 0; cut -= 1) {
        const field = document.querySelector(`[data-field="${CSS.escape(loc.slice(0, cut).join("."))}"]`);
        if (!field) continue;
        for (let up = field; up; up = up.parentElement) if (up.tagName === "DETAILS") up.open = true;
        field.scrollIntoView({ block: "nearest" });
        const input = field.querySelector("input, select, textarea");
        if (input) input.focus({ preventScroll: true });
        return;
      }
    }, 60);
  }

  let root = null;
  let host = null;
  function mount() {
    const element = document.getElementById("case-form");
    if (!element || element === host) return;
    if (root) root.unmount();
    host = element;
    root = window.ReactDOM.createRoot(element);
    root.render(h(Form));
  }

  window.slowdrift.form = { mount, show, section };
})();
