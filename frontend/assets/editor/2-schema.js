/* What the JSON Schema of a case says of one field: its kind, unit, default, limits and help. */
(function () {
  "use strict";
  const theCase = window.slowdrift.theCase;
  const SIGNS = { "x-gt": ">", "x-ge": "≥", "x-lt": "<", "x-le": "≤", exclusiveMinimum: ">", minimum: "≥", exclusiveMaximum: "<", maximum: "≤" };

  /* $ref followed, `null` alternatives gone; what stands beside them is kept. */
  function resolve(schema) {
    let found = schema || {};
    for (let guard = 0; guard < 8; guard += 1) {
      const { $ref, anyOf, ...rest } = found;
      if ($ref) found = { ...theCase.state.schema.$defs[$ref.split("/").pop()], model: $ref.split("/").pop(), ...rest };
      else if (anyOf && anyOf.some((one) => one.type === "null")) {
        const others = anyOf.filter((one) => one.type !== "null");
        found = others.length === 1 ? { ...others[0], ...rest, description: rest.description || others[0].description } : { ...rest, anyOf: others };
      } else break;
    }
    return found;
  }

  const quantity = (schema) => (schema["x-unit"] ? schema : (schema.anyOf || []).find((one) => one["x-unit"]));

  function kind(schema) {
    if (schema.properties) return "object";
    if (schema.patternProperties) return "named";
    if (schema.const !== undefined) return "const";
    if (schema.enum) return "choice";
    if (schema.type === "boolean") return "boolean";
    const tuples = (schema.anyOf || [schema]).filter((one) => one.prefixItems);
    if (tuples.length) return tuples[0].prefixItems[0].type === "array" ? "matrix" : "tuple";
    if (schema.type === "array") {
      const items = resolve(schema.items);
      if (items.prefixItems) return "matrix";
      return items.properties || items.oneOf ? "list" : "numbers";
    }
    if (quantity(schema)) return "quantity";
    return schema.type === "number" || schema.type === "integer" ? "number" : "text";
  }

  function shown(value) {
    if (value === null || value === undefined || value === "") return "";
    if (Array.isArray(value)) return value.map(shown).join(", ");
    return typeof value === "object" ? "" : String(value);
  }

  function unit(schema) {
    const found = quantity(schema) || quantity((schema.prefixItems || ((schema.anyOf || [])[0] || {}).prefixItems || [])[0] || {})
      || quantity(schema.items || {});
    return !found ? "" : found["x-unit"] === "rad" ? "deg" : found["x-unit"];
  }

  function accepted(schema) {
    const found = quantity(schema);
    const texts = found ? [found, ...(found.anyOf || [])].map((one) => one.description || "").filter((text) => text.startsWith("a number with")) : [];
    return texts[0] || "";
  }

  /* The schema's own words, its limits, its default and the units it takes. */
  function help(schema) {
    const limits = Object.keys(SIGNS).filter((key) => schema[key] !== undefined).map((key) => `${SIGNS[key]} ${schema[key]}`);
    const found = quantity(schema) || {};
    if (found !== schema) limits.push(...Object.keys(SIGNS).filter((key) => found[key] !== undefined).map((key) => `${SIGNS[key]} ${found[key]}`));
    const takes = [accepted(schema).replace("a number with a unit", "units"), limits.length ? `allowed: ${limits.join(" and ")} ${unit(schema)}`.trim() : ""];
    if (shown(schema.default)) takes.push(`default: ${shown(schema.default)} ${found["x-unit"] || ""}`.trim());
    const own = (schema.description || "").startsWith("a number with") ? "" : schema.description || "";
    return [own, takes.filter(Boolean).join("; ")].filter(Boolean).join(" — ");
  }

  const NAMES = {
    EA: "Axial stiffness EA", EI: "Bending stiffness EI", hs: "Significant height Hs", tz: "Zero-crossing period Tz", tp: "Peak period Tp",
    end_a: "End a (bottom, anchor)", end_b: "End b (top)", centre_of_gravity: "Centre of gravity x, y, z", seastates: "Wave systems",
  };
  function label(key) {
    if (NAMES[key]) return NAMES[key];
    const words = String(key).replace(/_/g, " ");
    return words.charAt(0).toUpperCase() + words.slice(1);
  }

  window.slowdrift.schema = { resolve, kind, unit, help, label, shown };
})();
