/* Line types, lines and what hangs on them: cards with names, copies, mirror images and rings. */
(function () {
  "use strict";
  const { theCase, schema: S, fields: F, parts: P } = window.slowdrift;
  const { h } = F;
  const model = (name) => S.resolve({ $ref: `#/$defs/${name}` });
  const metres = (value) => {
    const found = /^\s*([-+\d.eE]+)\s*(m|km|ft)?\s*$/.exec(String(value ?? ""));
    return found ? Number(found[1]) * ({ km: 1000, ft: 0.3048 }[found[2]] || 1) : 100;
  };
  const free = (group, wanted) => {
    let [name, number] = [wanted, 2];
    while (group && group[name] !== undefined) name = `${wanted} ${number++}`;
    return name;
  };

  function Card({ group, name, actions, children, open }) {
    const path = [group, name];
    const count = F.faultsAt(path, true).length;
    const what = group === "lines" ? "line" : "line type";
    return h("details", { className: "sd-card", open, "data-field": path.join(".") },
      h("summary", null, h("strong", null, name), count ? h("span", { className: "sd-count" }, count) : null),
      h("div", { className: "sd-card-head" },
        h("label", { className: "sd-rename" }, "Name",
          h(F.Typed, { id: `${F.idOf(path)}-name`, value: name, onCommit: (to) => to.trim() && theCase.edit({ op: "rename", path, to }), label: `Name of ${what} ${name}` })),
        actions,
        h("button", { type: "button", className: "sd-small sd-plain", "aria-label": `Remove ${what} ${name}`, onClick: () => F.remove(path) }, "Remove")),
      children);
  }

  function LineTypes({ tree }) {
    const types = tree.line_types || {};
    const add = () => F.set(["line_types", free(types, "chain")], { catalogue: "chain-R4-studless", diameter: "100 mm" });
    return h("div", null,
      Object.entries(types).map(([name, value], index) => {
        const copy = () => F.set(["line_types", free(types, `${name} copy`)], value);
        return h(Card, { key: index, open: true, group: "line_types", name, actions: h("button", { type: "button", className: "sd-small", onClick: copy }, "Copy") },
          h(P.Part, { path: ["line_types", name], schema: model("LineType"), value, skip: ["catalogue_values"] }));
      }),
      h("button", { type: "button", className: "sd-small", onClick: add }, "Add a line type"));
  }

  /* --- lines ---------------------------------------------------------------------------------------------------- */
  const ENDS = {
    fairlead: ["Fairlead on the vessel", () => ({ fairlead: ["0", "0", "0"] })],
    azimuth: ["Anchor: azimuth and radius", (depth) => ({ anchor: { azimuth: "45 deg", radius: `${Math.round(1.4 * depth)} m` } })],
    pretension: ["Anchor: azimuth and pretension", () => ({ anchor: { azimuth: "45 deg", pretension: "1000 kN" } })],
    point: ["Anchor at a point", (depth) => ({ anchor: { point: [String(Math.round(1.4 * depth)), "0"] } })],
    pinned: ["Pinned point", (depth) => ({ pinned: ["0", "0", String(-Math.round(depth))] })],
  };
  const endKind = (end) => {
    if (!end || end.fairlead !== undefined) return "fairlead";
    if (end.pinned !== undefined) return "pinned";
    const anchor = end.anchor || {};
    return anchor.point !== undefined ? "point" : anchor.radius !== undefined ? "azimuth" : "pretension";
  };
  const SHOWN = { azimuth: ["azimuth", "radius", "pretension"], pretension: ["azimuth", "pretension"], point: ["point", "pretension"] };

  function End({ path, value, depth, name }) {
    const now = endKind(value);
    const schema = model("End");
    const field = (key) => h(P.One, { key, path: [...path, key], name: key, raw: schema.properties[key], value: (value || {})[key], required: true });
    return h("fieldset", { className: "sd-part" },
      h("legend", null, S.label(name)),
      h(F.Faults, { path }),
      h("select", { className: "sd-input", value: now, "aria-label": `Kind of ${S.label(name)}`, onChange: (event) => F.set(path, ENDS[event.target.value][1](depth)) },
        Object.entries(ENDS).map(([key, [words]]) => h("option", { key, value: key }, words))),
      now === "fairlead" ? field("fairlead") : null,
      now === "pinned" ? [field("pinned"), h(P.Optional, { key: "motion", path: [...path, "motion"], name: "motion", schema: S.resolve(schema.properties.motion), value: (value || {}).motion })] : null,
      SHOWN[now] ? h(P.Part, { path: [...path, "anchor"], schema: model("Anchor"), value: (value || {}).anchor, only: SHOWN[now] }) : null);
  }

  function Segments({ path, value }) {
    const segments = Array.isArray(value) ? value : [];
    const add = () => theCase.edit({ op: "append", path, value: { ...(segments[segments.length - 1] || { type: "", length: "100 m", elements: "20" }) } });
    return h("fieldset", { className: "sd-part" },
      h("legend", null, "Segments, from end a"), h(F.Faults, { path }),
      segments.map((segment, index) => h("div", { key: index, className: "sd-row" },
        h(P.Part, { path: [...path, index], schema: model("Segment"), value: segment }),
        segments.length > 1 ? h("button", { type: "button", className: "sd-small sd-plain", "aria-label": `Remove segment ${index + 1}`, onClick: () => F.remove([...path, index]) }, "Remove") : null)),
      h("button", { type: "button", className: "sd-small", onClick: add }, "Add a segment"));
  }

  function Ring({ name, close }) {
    const { useState } = window.React;
    const [count, setCount] = useState("4");
    const [step, setStep] = useState("");
    const go = () => { theCase.edit({ op: "pattern", path: ["lines", name], count, step }); close(); };
    const input = (value, change, label, placeholder) => h("label", null, label, h("input", { className: "sd-input", value, placeholder, onChange: (event) => change(event.target.value) }));
    return h("div", { className: "sd-ring", role: "group", "aria-label": "Ring of lines" },
      input(count, setCount, "lines in all", ""), input(step, setStep, "degrees apart", "360 / lines"),
      h("button", { type: "button", className: "sd-small", onClick: go }, "Make the ring"),
      h("button", { type: "button", className: "sd-small sd-plain", onClick: close }, "Not now"));
  }

  function LineCard({ name, value, depth, open }) {
    const { useState } = window.React;
    const [ring, setRing] = useState(false);
    const path = ["lines", name];
    const act = (words, edit, title) => h("button", { type: "button", className: "sd-small", title, onClick: () => theCase.edit({ path, ...edit }) }, words);
    const actions = h("span", { className: "sd-actions" },
      act("Copy", { op: "copy" }, "The same line again"),
      act("Mirror ↕", { op: "mirror", axis: "x" }, "To the other side of the vessel's axis: port and starboard"),
      act("Mirror ↔", { op: "mirror", axis: "y" }, "To the other end of the vessel: bow and stern"),
      h("button", { type: "button", className: "sd-small", "aria-expanded": ring, title: "Equal lines by azimuth about the vessel", onClick: () => setRing(!ring) }, "Ring …"));
    return h(Card, { group: "lines", name, actions, open },
      ring ? h(Ring, { name, close: () => setRing(false) }) : null,
      h(F.Faults, { path }),
      h(Segments, { path: [...path, "segments"], value: (value || {}).segments }),
      h(End, { path: [...path, "end_a"], value: (value || {}).end_a, depth, name: "end_a" }),
      h(End, { path: [...path, "end_b"], value: (value || {}).end_b, depth, name: "end_b" }),
      h(P.Part, { path, schema: model("Line"), value, only: ["multiplicity", "allow_stretch"] }));
  }

  function Lines({ tree }) {
    const lines = tree.lines || {};
    const types = Object.keys(tree.line_types || {});
    const depth = metres(theCase.at(tree, ["environment", "depth"]));
    const add = () => F.set(["lines", free(lines, `line ${Object.keys(lines).length + 1}`)], {
      segments: [{ type: types[0] || "chain", length: `${Math.round(1.9 * depth)} m`, elements: "40" }],
      end_a: { anchor: { azimuth: "45 deg", radius: `${Math.round(1.4 * depth)} m` } },
      end_b: tree.vessel ? { fairlead: ["0", "0", "0"] } : { pinned: ["0", "0", "0"] },
    });
    return h("div", null,
      types.length ? null : h("p", { className: "sd-hint" }, "A line needs a line type: add one first."),
      Object.entries(lines).map(([name, value], index) => h(LineCard, { key: index, name, value, depth, open: index === 0 || Object.keys(lines).length < 3 })),
      h("button", { type: "button", className: "sd-small", onClick: add }, "Add a line"));
  }

  function Attachments({ tree }) {
    const items = Array.isArray(tree.attachments) ? tree.attachments : [];
    const add = () => theCase.edit({ op: "append", path: ["attachments"], value: { line: Object.keys(tree.lines || {})[0] || "", arc_length: "50 m", mass: "1 t" } });
    return h("div", null,
      items.map((item, index) => h("div", { key: index, className: "sd-card" },
        h("div", { className: "sd-card-head" }, h("strong", null, `Attachment ${index + 1}`),
          h("button", { type: "button", className: "sd-small sd-plain", "aria-label": `Remove attachment ${index + 1}`, onClick: () => F.remove(["attachments", index]) }, "Remove")),
        h(P.Part, { path: ["attachments", index], schema: model("Attachment"), value: item }))),
      h("button", { type: "button", className: "sd-small", onClick: add }, "Add a clump weight or buoy"));
  }

  window.slowdrift.rigging = { LineTypes, Lines, Attachments };
})();
