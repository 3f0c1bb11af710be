/* One field of the form: label, help from the schema, the value as written, the fault where it is. */
(function () {
  "use strict";
  const { theCase, schema: S } = window.slowdrift;
  const h = (...args) => window.React.createElement(...args);
  const COMMIT_MS = 220;
  const same = (a, b) => a.length === b.length && a.every((part, i) => String(part) === String(b[i]));
  const idOf = (path) => `f-${path.join("-").replace(/[^A-Za-z0-9_-]/g, "_")}`;
  const set = (path, value, words) => theCase.edit({ op: "set", path, value, words });
  const remove = (path) => theCase.edit({ op: "remove", path });

  /* The fault of exactly this field; `deep` also takes those further in. */
  function faultsAt(path, deep) {
    return theCase.state.errors.filter((one) => {
      const loc = one.loc || [];
      return deep ? same(loc.slice(0, path.length), path) : same(loc, path);
    });
  }

  /* A text input that owns what is being typed and hands it on when the fingers rest. */
  function Typed({ id, value, onCommit, placeholder, describedBy, wrong, list, area, label, className }) {
    const { useState, useRef, useEffect } = window.React;
    const [own, setOwn] = useState(null);
    const timer = useRef(null);
    const latest = useRef(null);
    const commit = (text) => {
      clearTimeout(timer.current);
      latest.current = null;
      if (text !== null && text !== value) onCommit(text);
    };
    useEffect(() => () => latest.current !== null && commit(latest.current), []);
    const change = (event) => {
      const text = event.target.value;
      setOwn(text);
      latest.current = text;
      clearTimeout(timer.current);
      timer.current = setTimeout(() => commit(text), COMMIT_MS);
    };
    return h(area ? "textarea" : "input", {
      id, value: own === null ? value : own, placeholder, onChange: change, list, "aria-label": label, rows: area,
      onBlur: () => { if (own !== null) commit(own); setOwn(null); },
      onKeyDown: (event) => event.key === "Enter" && !area && commit(own),
      type: area ? undefined : "text", autoComplete: "off", spellCheck: false,
      className: `sd-input ${className || ""}`, "aria-describedby": describedBy, "aria-invalid": wrong ? "true" : undefined,
    });
  }

  function Help({ id, text, what }) {
    const { useState } = window.React;
    const [open, setOpen] = useState(false);
    if (!text) return null;
    return h("span", { className: "sd-help" },
      h("button", {
        type: "button", className: "sd-help-button", "aria-label": `Help: ${what}`, "aria-expanded": open, "aria-controls": id,
        onClick: () => setOpen(!open), onKeyDown: (event) => event.key === "Escape" && setOpen(false), onBlur: () => setOpen(false),
      }, "?"),
      h("span", { id, role: "note", className: open ? "sd-help-text sd-help-open" : "sd-help-text" }, text));
  }

  const Faults = ({ path, id }) =>
    h("span", { id, className: "sd-field-wrong", "aria-live": "polite" }, faultsAt(path).map((one) => one.message).join(" "));

  function Frame({ path, name, schema, children, required, wide, title }) {
    const id = idOf(path);
    const what = title || S.label(name);
    const unit = S.unit(schema);
    return h("div", { className: `sd-field${wide ? " sd-field-wide" : ""}`, "data-field": path.join(".") },
      h("div", { className: "sd-field-head" },
        h("label", { htmlFor: id }, what, required ? h("span", { className: "sd-needed", title: "required" }, " *") : null),
        unit ? h("span", { className: "sd-unit" }, unit) : null,
        h(Help, { id: `${id}-help`, text: S.help(schema), what })),
      children, h(Faults, { path, id: `${id}-wrong` }));
  }

  const described = (path) => `${idOf(path)}-help ${idOf(path)}-wrong`;

  function Scalar({ path, name, schema, value, required, list, title }) {
    const kind = S.kind(schema);
    const words = kind === "text";
    const known = schema.default !== undefined && S.shown(schema.default);
    const commit = (text) => (text.trim() === "" ? value !== undefined && remove(path) : set(path, words ? text : text.trim(), words));
    return h(Frame, { path, name, schema, required, title },
      h(Typed, {
        id: idOf(path), value: S.shown(value), onCommit: commit, describedBy: described(path), wrong: faultsAt(path).length, list,
        placeholder: known ? `default ${known}` : (schema.examples || [])[0] || "",
      }));
  }

  function Choice({ path, name, schema, value, required }) {
    const options = schema.enum || [];
    const known = schema.default;
    return h(Frame, { path, name, schema, required },
      h("select", {
        id: idOf(path), className: "sd-input", value: value ?? "", "aria-describedby": described(path),
        onChange: (event) => (event.target.value ? set(path, event.target.value) : remove(path)),
      }, required ? null : h("option", { value: "" }, known ? `default: ${known}` : "not set"),
        options.map((one) => h("option", { key: one, value: one }, one))));
  }

  function Switch({ path, name, schema, value }) {
    const on = value ?? schema.default ?? false;
    return h("div", { className: "sd-field sd-field-switch", "data-field": path.join(".") },
      h("input", { type: "checkbox", id: idOf(path), checked: Boolean(on), "aria-describedby": described(path),
        onChange: (event) => set(path, event.target.checked) }),
      h("label", { htmlFor: idOf(path) }, S.label(name)),
      h(Help, { id: `${idOf(path)}-help`, text: S.help(schema), what: S.label(name) }),
      h(Faults, { path, id: `${idOf(path)}-wrong` }));
  }

  /* Three lengths side by side. A blank among them is a zero once another is given; the field shows it. */
  function Tuple({ path, name, schema, value, required }) {
    const size = Math.max(...(schema.anyOf || [schema]).map((one) => (one.prefixItems || []).length));
    const least = Math.min(...(schema.anyOf || [schema]).map((one) => (one.prefixItems || [0, 0, 0]).length));
    const axes = name === "radii_of_gyration" ? ["roll", "pitch", "yaw"] : ["x", "y", "z"];
    const now = Array.isArray(value) ? value : [];
    const commit = (index, text) => {
      const next = Array.from({ length: Math.max(now.length, index + 1, least) }, (_, i) => (i === index ? text.trim() : S.shown(now[i])));
      if (next.every((part) => part === "")) return value !== undefined && remove(path);
      while (next.length > least && next[next.length - 1] === "") next.pop();
      return set(path, next.map((part) => (part === "" ? "0" : part)));
    };
    const deep = faultsAt(path, true).filter((one) => one.loc.length > path.length);
    return h(Frame, { path, name, schema, required, wide: true },
      h("div", { className: "sd-triple", role: "group", "aria-label": S.label(name) },
        Array.from({ length: size }, (_, i) =>
          h(Typed, { key: i, id: i ? `${idOf(path)}-${i}` : idOf(path), value: S.shown(now[i]), placeholder: axes[i], label: `${S.label(name)}, ${axes[i]}`,
            onCommit: (text) => commit(i, text), wrong: faultsAt([...path, i]).length, describedBy: described(path) }))),
      deep.length ? h("span", { className: "sd-field-wrong" }, deep.map((one) => one.message).join(" ")) : null);
  }

  /* Numbers separated by commas; a matrix has one row a line. */
  function Numbers({ path, name, schema, value, required, matrix }) {
    const shown = matrix ? (value || []).map((row) => S.shown(row)).join("\n") : S.shown(value);
    const row = (text) => text.split(/[,;\s]*[,;][,;\s]*/).map((part) => part.trim()).filter(Boolean);
    const commit = (text) => {
      if (!text.trim()) return value !== undefined && remove(path);
      return set(path, matrix ? text.trim().split("\n").map((line) => row(line.includes(",") ? line : line.trim().replace(/\s+/g, ","))) : row(text));
    };
    const deep = faultsAt(path, true).filter((one) => one.loc.length > path.length);
    return h(Frame, { path, name, schema, required, wide: true },
      h(Typed, { id: idOf(path), value: shown, onCommit: commit, area: matrix ? 4 : undefined, describedBy: described(path),
        placeholder: matrix ? "one row a line, commas between" : "commas between", wrong: deep.length || faultsAt(path).length }),
      deep.length ? h("span", { className: "sd-field-wrong" }, deep.map((one) => one.message).join(" ")) : null);
  }

  window.slowdrift.fields = { h, Typed, Help, Faults, Frame, Scalar, Choice, Switch, Tuple, Numbers, faultsAt, idOf, set, remove };
})();
