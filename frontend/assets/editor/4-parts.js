/* Parts of a case: a mapping with its fields, a part that may be left out, a list of wave systems or segments. */
(function () {
  "use strict";
  const { theCase, schema: S, fields: F } = window.slowdrift;
  const { h } = F;

  /* Fields that few change stand under "More", by model. */
  const MORE = {
    Case: [], Environment: [], Water: [], Seabed: ["damping"],
    Vessel: ["inertia", "heading", "trim", "mean_drift", "fairlead_kinematics"],
    Hydrodynamics: ["reference_point"], Statics: ["tolerance", "max_iterations"],
    FrequencyDomain: ["linearisation", "include_low_velocities", "tolerance", "max_iterations"],
    TimeDomain: ["scheme", "wave_kinematics", "amplitudes", "wave_step", "tolerance", "max_iterations", "first_seed"],
    LineType: ["stiffness", "drag_diameter", "volume", "submerged_weight"], Line: ["allow_stretch"], Segment: [], Damping: ["linear_matrix"], RegularWave: ["phase"],
  };
  const SEAS = {
    jonswap: { model: "Jonswap", words: "JONSWAP", made: { spectrum: "jonswap", hs: "3 m", tp: "10 s", gamma: "3.3", direction: "180 deg" } },
    "pierson-moskowitz": { model: "PiersonMoskowitz", words: "Pierson-Moskowitz", made: { spectrum: "pierson-moskowitz", hs: "3 m", tp: "10 s", direction: "180 deg" } },
    tabulated: { model: "Tabulated", words: "Table of densities",
      made: { spectrum: "tabulated", frequencies: ["0.4", "0.6", "1.0"], densities: ["0", "4", "0"], direction: "180 deg" } },
    regular: { model: "RegularWave", words: "Regular wave", made: { wave: "regular", height: "4 m", period: "10 s", direction: "180 deg" } },
  };
  const seaKind = (sea) => ((sea || {}).wave ? "regular" : (sea || {}).spectrum || "jonswap");

  /* What a part that may be left out begins with. */
  const STARTS = {
    Current: () => ({ depths: ["0", String(theCase.at(theCase.state.tree, ["environment", "depth"]) || "100")], speeds: ["1", "0"], direction: "0 deg" }),
    Hydrodynamics: () => ({ data: ((theCase.state.dataSets[0] || {}).name) || "" }),
    Motion: () => ({ surge: { amplitude: "1 m", period: "10 s" } }),
    Harmonic: () => ({ amplitude: "1 m", period: "10 s" }),
    Diagonal: () => ({ surge: "1e5" }),
  };

  function Part({ path, schema, value, skip, only }) {
    const model = schema.model || "";
    const entries = Object.entries(schema.properties || {}).filter(([name]) => !(skip || []).includes(name) && (!only || only.includes(name)));
    const needed = schema.required || [];
    const hidden = (name) => (MORE[model] || []).includes(name) && (value || {})[name] === undefined && !F.faultsAt([...path, name], true).length;
    const draw = ([name, raw]) => h(One, { key: name, path: [...path, name], name, raw, value: (value || {})[name], required: needed.includes(name) });
    const small = ([, raw]) => !["object", "list", "named"].includes(S.kind(S.resolve(raw)));
    const near = entries.filter(([name]) => !hidden(name));
    const far = entries.filter(([name]) => hidden(name));
    return h(window.React.Fragment, null,
      h(F.Faults, { path }),
      h("div", { className: "sd-fields" }, near.filter(small).map(draw)),
      near.filter((one) => !small(one)).map(draw),
      far.length ? h("details", { className: "sd-more" }, h("summary", null, "More"),
        h("div", { className: "sd-fields" }, far.filter(small).map(draw)), far.filter((one) => !small(one)).map(draw)) : null);
  }

  function One({ path, name, raw, value, required }) {
    const schema = S.resolve(raw);
    const kind = S.kind(schema);
    const props = { path, name, schema, value, required };
    if (kind === "const") return null;
    if (kind === "choice") return h(F.Choice, props);
    if (kind === "boolean") return h(F.Switch, props);
    if (kind === "tuple") return h(F.Tuple, props);
    if (kind === "matrix") return h(F.Numbers, { ...props, matrix: true });
    if (kind === "numbers") return h(F.Numbers, props);
    if (kind === "list") return name === "seastates" ? h(Seas, props) : null;
    if (kind === "object") return h(Optional, props);
    const list = path.slice(-2).join(".") === "hydrodynamics.data" ? "sd-data-sets" : path.includes("segments") && name === "type" ? "sd-line-types"
      : path[0] === "attachments" && name === "line" ? "sd-lines" : undefined;
    return h(F.Scalar, { ...props, list });
  }

  /* A part with a heading; one that may be left out has a button for it. */
  function Optional({ path, name, schema, value, required }) {
    const there = value !== undefined && value !== null;
    const words = S.label(name);
    const optional = !required;
    const add = () => F.set(path, (STARTS[schema.model] || (() => ({})))());
    if (!there && optional) {
      return h("div", { className: "sd-absent" },
        h("button", { type: "button", className: "sd-small", onClick: add }, `Add ${words.toLowerCase()}`),
        h(F.Help, { id: `${F.idOf(path)}-help`, text: S.help(schema), what: words }), h(F.Faults, { path }));
    }
    return h("fieldset", { className: "sd-part", "data-field": path.join(".") },
      h("legend", null, words, h(F.Help, { id: `${F.idOf(path)}-help`, text: S.help(schema), what: words }),
        optional ? h("button", { type: "button", className: "sd-small sd-plain", "aria-label": `Remove ${words.toLowerCase()}`, onClick: () => F.remove(path) }, "Remove") : null),
      h(Part, { path, schema, value }));
  }

  function Seas({ path, name, schema, value }) {
    const seas = Array.isArray(value) ? value : [];
    const add = () => theCase.edit({ op: "append", path, value: SEAS.jonswap.made });
    return h("fieldset", { className: "sd-part" },
      h("legend", null, S.label(name), h(F.Help, { id: `${F.idOf(path)}-help`, text: S.help(schema), what: S.label(name) })),
      h(F.Faults, { path }),
      seas.map((sea, index) => {
        const kind = SEAS[seaKind(sea)] || SEAS.jonswap;
        const here = [...path, index];
        return h("div", { key: index, className: "sd-card" },
          h("div", { className: "sd-card-head" },
            h("select", { className: "sd-input", value: seaKind(sea), "aria-label": `Kind of wave system ${index + 1}`,
              onChange: (event) => F.set(here, SEAS[event.target.value].made) },
              Object.entries(SEAS).map(([key, one]) => h("option", { key, value: key }, one.words))),
            h("button", { type: "button", className: "sd-small sd-plain", "aria-label": `Remove wave system ${index + 1}`, onClick: () => F.remove(here) }, "Remove")),
          h(Part, { path: here, schema: S.resolve({ $ref: `#/$defs/${kind.model}` }), value: sea }));
      }),
      h("button", { type: "button", className: "sd-small", onClick: add }, "Add a wave system"));
  }

  window.slowdrift.parts = { Part, One, Optional };
})();
