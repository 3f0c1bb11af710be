/* What the service says of the case: ready, or what to mend and where; and the way to a run. */
(function () {
  "use strict";
  const { theCase, fields: F, form, yaml } = window.slowdrift;
  const { h } = F;
  let root = null;
  let host = null;

  function Fault({ one }) {
    const loc = one.loc || [];
    return h("li", null,
      h("button", { type: "button", className: "sd-problem", onClick: () => { form.section(loc); yaml.goTo(one.line || 0, one.field); }, "data-line": one.line || 0, "data-field": one.field },
        one.line ? h("span", { className: "sd-problem-line" }, `Line ${one.line}`) : null,
        one.field ? h("code", null, one.field) : null, h("span", null, one.message)),
      loc.length ? h("button", { type: "button", className: "sd-small sd-plain", "aria-label": `Go to the field ${one.field}`, onClick: () => form.show(loc) }, "Field") : null);
  }

  const Box = ({ kind, title, children }) => h("div", { className: `sd-box sd-box-${kind}` }, h("strong", null, title), children);

  function Answer() {
    const { useReducer, useEffect } = window.React;
    const [, redraw] = useReducer((n) => n + 1, 0);
    useEffect(() => theCase.listen(redraw), []);
    const { text, errors, problem, checked } = theCase.state;
    if (!text.trim()) return h("p", { className: "sd-hint" }, "The case is checked as you write. Start from an example, a run, or an empty case.");
    if (errors.length) {
      return h(Box, { kind: "wrong", title: errors.length > 1 ? `${errors.length} things to mend` : "One thing to mend" },
        h("ul", { className: "sd-problems" }, errors.map((one, index) => h(Fault, { key: index, one }))));
    }
    if (problem) return h(Box, { kind: "wrong", title: problem.title || "The case was not accepted" }, h("p", null, problem.detail || ""));
    if (!checked) return h("p", { className: "sd-hint" }, "Checking …");
    const names = (checked.analyses || []).map((name) => name.replace(/_/g, " ")).join(", ");
    return h("div", { className: "sd-ready" }, h(Box, { kind: (checked.warnings || []).length ? "noted" : "good", title: `“${checked.name}” is ready to run` },
      h("p", null, `Analyses: ${names}.`),
      (checked.warnings || []).length ? h("ul", null, checked.warnings.map((words, index) => h("li", { key: index }, words))) : null));
  }

  function answer() {
    const element = document.getElementById("case-answer");
    if (element && element !== host) {
      if (root) root.unmount();
      host = element;
      root = window.ReactDOM.createRoot(element);
      root.render(h(Answer));
    }
    return "on";
  }

  const told = (title, message) =>
    window.dash_clientside.set_props("notices", { sendNotifications: [{ action: "show", id: title, title, message, color: "red" }] });

  /* Store the case, start the run, go there. */
  async function run(clicks) {
    if (!clicks) return "";
    const text = theCase.state.text;
    if (!text.trim()) return told("There is nothing to run", "Choose an example or write a case."), "";
    theCase.set("case-run", { loading: true });
    try {
      const saved = await theCase.ask(`${theCase.API}/cases`, text, "application/yaml");
      if (!saved.ok) {
        theCase.check();
        return told(saved.body.title || "Not started", saved.body.detail || "The case has faults; they stand beside their fields."), "";
      }
      const made = await theCase.ask(`${theCase.API}/runs`, JSON.stringify({ case_id: saved.body.id }));
      if (!made.ok) return told(made.body.title || "Not started", made.body.detail || ""), "";
      window.history.pushState({}, "", `${theCase.prefix()}runs/${made.body.id}`);
      window.dispatchEvent(new CustomEvent("_dashprivate_pushstate"));
      window.scrollTo(0, 0);
    } catch (error) {
      told("Not started", "The service does not answer. Your case is kept in this browser.");
    } finally {
      theCase.set("case-run", { loading: false });
    }
    return "";
  }

  const EMPTY = "slowdrift: 1\nname: New case\nenvironment:\n  depth: 100 m\nline_types: {}\nlines: {}\nanalyses:\n  statics: {}\n";
  function empty(clicks) {
    const text = theCase.state.text.trim();
    if (!clicks || (text && !window.confirm("Replace the case in the editor with an empty one?"))) return window.dash_clientside.no_update;
    return EMPTY;
  }

  Object.assign((window.dash_clientside.slowdrift = window.dash_clientside.slowdrift || {}), {
    answer, run, empty,
    recheck: () => (theCase.check(), ""),
    benchView: (view) => view,
    savedCase(id) {
      const keep = window.dash_clientside.no_update;
      if (!id) return keep;
      const text = theCase.state.text.trim();
      if (!text || window.confirm("Replace the case in the editor with this one?")) {
        fetch(`${theCase.API}/cases/${encodeURIComponent(id)}`).then((found) => found.json()).then((found) => theCase.set("case-text", { value: found.yaml })).catch(() => {});
      }
      return null;
    },
  });
})();
