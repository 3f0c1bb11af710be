/* The case being written: one text, its tree, what is wrong with it. Form and YAML both read and change it here. */
(function () {
  "use strict";
  const API = "/api/v1";
  const DRAFT = "slowdrift.draft";
  const EDITS = "slowdrift.draft.edits";
  const READ_MS = 180;
  const CHECK_MS = 260;
  const RETRY_MS = 1500;
  const RETRIES = 40;
  const config = () => JSON.parse(document.getElementById("_dash-config").textContent);
  const prefix = () => config().requests_pathname_prefix;
  const set = (id, props) => document.getElementById("new-page") && window.dash_clientside.set_props(id, props);

  const state = {
    text: "", tree: {}, readError: null, refused: null, pending: [], errors: [], problem: null, checked: null, checking: false,
    schema: null, dataSets: [],
  };
  const listeners = new Set();
  let timers = {};
  let flying = false;
  let checkedText = null;
  let turn = 0;

  const emit = () => listeners.forEach((listener) => listener());
  const later = (name, ms, act) => {
    clearTimeout(timers[name]);
    timers[name] = setTimeout(act, ms);
  };

  function keep() {
    try {
      if (state.text || localStorage.getItem(DRAFT)) localStorage.setItem(DRAFT, state.text);
      if (state.pending.length) localStorage.setItem(EDITS, JSON.stringify(state.pending));
      else localStorage.removeItem(EDITS);
    } catch (error) {
      /* storage is full or closed: the text is still on the screen */
    }
  }

  async function ask(url, body, type) {
    const answer = await fetch(url, { method: "POST", credentials: "same-origin", headers: { "content-type": type || "application/json" }, body });
    const found = answer.headers.get("content-type") || "";
    return { ok: answer.ok, status: answer.status, body: found.includes("json") ? await answer.json() : {} };
  }

  /* --- text in ------------------------------------------------------------------------------------------------- */
  function typed(text) {
    if (text === state.text) return;
    state.text = text;
    state.refused = null;
    keep();
    later("read", READ_MS, read);
    later("check", CHECK_MS, check);
    emit();
  }

  async function read() {
    const sent = state.text;
    if (!sent.trim()) {
      Object.assign(state, { tree: {}, readError: null });
      return emit();
    }
    try {
      const { ok, body } = await ask(`${prefix()}editor/read`, JSON.stringify({ text: sent }));
      if (ok && sent === state.text && !state.pending.length) take(body);
    } catch (error) {
      /* away.js says so and comes back to us */
    }
  }

  function take(body) {
    if (body.tree) state.tree = body.tree;
    state.readError = body.error;
    emit();
  }

  /* --- edits of the form --------------------------------------------------------------------------------------- */
  const at = (tree, path) => path.reduce((here, part) => (here === null || here === undefined ? undefined : here[part]), tree);

  /* The form shows its own change at once; the text follows when the server has written it. */
  function guess(tree, edit) {
    const copy = structuredClone(tree || {});
    let here = copy;
    for (const part of edit.path.slice(0, -1)) {
      if (here[part] === null || here[part] === undefined) here[part] = {};
      here = here[part];
      if (typeof here !== "object") return tree;
    }
    const last = edit.path[edit.path.length - 1];
    if (edit.op === "set") here[last] = edit.value;
    else if (edit.op === "remove" && Array.isArray(here)) here.splice(last, 1);
    else if (edit.op === "remove") delete here[last];
    else if (edit.op === "append") here[last] = [...(here[last] || []), edit.value];
    return copy;
  }

  function edit(...edits) {
    for (const one of edits) {
      if (["set", "remove", "append"].includes(one.op)) state.tree = guess(state.tree, one);
      state.pending.push(one);
    }
    state.refused = null;
    keep();
    emit();
    flush();
  }

  async function flush() {
    if (flying || !state.pending.length) return;
    flying = true;
    const [sent, edits] = [state.text, state.pending.slice()];
    let answer;
    try {
      answer = await ask(`${prefix()}editor/apply`, JSON.stringify({ text: sent, edits }));
    } catch (error) {
      return; // kept in `pending`; slowdrift:back tries again
    } finally {
      flying = false;
    }
    if (sent !== state.text) return flush(); // typed meanwhile: the same edits on the new text
    state.pending.splice(0, edits.length);
    if (!answer.ok) state.refused = `The change was not accepted (${answer.status}).`;
    else {
      state.text = answer.body.text;
      state.refused = answer.body.refused || null;
      if (!state.pending.length) take(answer.body);
      set("case-text", { value: state.text });
    }
    keep();
    emit();
    later("check", 40, check);
    flush();
  }

  /* --- checks and statics -------------------------------------------------------------------------------------- */
  async function check() {
    const text = state.text;
    if (text === checkedText || state.pending.length) return;
    if (!text.trim()) {
      Object.assign(state, { errors: [], problem: null, checked: null });
      checkedText = text;
      set("case-preview", { data: null });
      return emit();
    }
    const mine = (turn += 1);
    state.checking = true;
    emit();
    try {
      const { ok, body } = await ask(`${API}/cases/check`, text, "application/yaml");
      if (mine !== turn || text !== state.text) return;
      checkedText = text;
      state.errors = ok ? [] : (body.errors || []).map((one) => ({ ...one, field: one.field || (one.loc || []).join(".") }));
      state.problem = ok ? null : body;
      state.checked = ok ? body : null;
      if (ok) preview(text, mine);
    } catch (error) {
      /* away */
    } finally {
      state.checking = false;
      emit();
    }
  }

  /* A worker that starts or is busy answers too late (503, 504): ask again while this is still the text. */
  async function preview(text, mine, tries = 0) {
    const started = performance.now();
    set("preview-note", { children: tries ? "The preview takes longer than usual; trying again …" : "Finding the equilibrium …" });
    const { ok, status, body } = await ask(`${API}/preview`, text, "application/yaml").catch(() => ({ ok: false, body: null }));
    if (mine !== turn || !body) return;
    if ((status === 503 || status === 504) && tries < RETRIES) return later("preview", RETRY_MS, () => mine === turn && preview(text, mine, tries + 1));
    const took = Math.round(performance.now() - started);
    set("case-preview", { data: ok ? { shape: body, text, took } : { problem: body, text } });
  }

  /* --- life ---------------------------------------------------------------------------------------------------- */
  function open(fresh) {
    Object.assign(state, { text: "", tree: {}, readError: null, refused: null, errors: [], problem: null, checked: null, pending: [] });
    checkedText = null;
    fetch(`${API}/data-sets?limit=200`).then((a) => (a.ok ? a.json() : { items: [] })).then((page) => {
      state.dataSets = page.items || [];
      emit();
    }).catch(() => {});
    if (!state.schema) loadSchema();
    if (fresh) return null;
    const draft = localStorage.getItem(DRAFT) || "";
    try {
      state.pending = JSON.parse(localStorage.getItem(EDITS) || "[]");
    } catch (error) {
      state.pending = [];
    }
    if (state.pending.length) setTimeout(flush, 0);
    return draft;
  }

  function loadSchema() {
    fetch(`${API}/schema`).then((answer) => answer.json()).then((schema) => {
      state.schema = schema;
      emit();
    }).catch(() => {});
  }

  window.addEventListener("slowdrift:back", () => {
    if (!document.getElementById("new-page")) return;
    if (!state.schema) loadSchema();
    checkedText = null;
    flush();
    later("read", 0, read);
    later("check", 100, check);
  });

  window.slowdrift = Object.assign(window.slowdrift || {}, {
    theCase: { state, typed, edit, check: () => ((checkedText = null), check()), at, open, ask, set, API, prefix,
      listen: (listener) => (listeners.add(listener), () => listeners.delete(listener)) },
  });
})();
