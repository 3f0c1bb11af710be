/* Live state of runs: server-sent events from the REST API, polling where those do not come through. */
(function () {
  "use strict";
  const { api } = window.slowdrift; // the service, or what a share link opens of it
  const FINAL = ["succeeded", "failed", "cancelled"];
  const POLL_MS = 3000;
  const nothing = () => window.dash_clientside.no_update;
  /* Only while that page is on the screen: an event may come in after the reader has left. */
  const set = (page, id, props) => document.getElementById(page) && window.dash_clientside.set_props(id, props);
  let current = null; // {url, poll, on, source, timer}: one stream a page, closed while the page is hidden

  function stop() {
    if (!current) return;
    if (current.source) current.source.close();
    clearTimeout(current.timer);
    current.source = current.timer = null;
  }

  function close() {
    stop();
    current = null;
  }

  function start(stream) {
    if (!stream || stream.ended) return;
    stream.source = new EventSource(api() + stream.url);
    stream.source.addEventListener("run", (event) => {
      const run = JSON.parse(event.data);
      stream.on(run);
      if (stream.single && FINAL.includes(run.state)) {
        stream.ended = true;
        stop();
      }
    });
    stream.source.onerror = () => {
      // The browser reconnects by itself unless the answer was a refusal; then ask now and again instead.
      if (stream.source && stream.source.readyState === EventSource.CLOSED) poll(stream);
    };
  }

  async function poll(stream) {
    if (stream !== current || stream.ended) return;
    try {
      const answer = await fetch(api() + stream.poll, { credentials: "same-origin" });
      if (answer.ok) {
        const body = await answer.json();
        (body.items || [body]).forEach(stream.on);
        stream.ended = stream.single && FINAL.includes(body.state);
      }
    } catch (error) {
      /* the server is away: try again later */
    }
    if (stream === current && !stream.ended) stream.timer = setTimeout(() => poll(stream), POLL_MS);
  }

  document.addEventListener("visibilitychange", () => {
    if (document.hidden) stop();
    else if (current && !current.source && !current.ended) start(current);
  });

  /* --- runs page ------------------------------------------------------------------------------------------------ */
  let waiting = null;

  function showInGrid(run) {
    const api = document.getElementById("runs-grid") && window.dash_ag_grid && grid();
    if (!api) return;
    if (api.getRowNode(run.id)) {
      api.applyTransaction({ update: [run] });
    } else if (!waiting) {
      // A run that this page does not hold: let the server say which page it belongs to, at most twice a second.
      waiting = setTimeout(() => {
        waiting = null;
        set("runs-page", "runs-refresh", { data: Date.now() });
      }, 500);
    }
  }

  function grid() {
    try {
      return window.dash_ag_grid.getApi("runs-grid");
    } catch (error) {
      return null;
    }
  }

  function openRuns() {
    close();
    current = { url: "/events", poll: "/runs?limit=25", single: false, on: knownOrNew() };
    start(current);
    return "on";
  }

  /* The stream begins with the present state of runs; only what is new since the page was made asks for a reload. */
  function knownOrNew() {
    const opened = Date.now();
    return (run) => {
      const api = grid();
      const known = api && api.getRowNode(run.id);
      if (known || Date.parse(run.created_at) > opened - 2000) showInGrid(run);
    };
  }

  /* --- run page ------------------------------------------------------------------------------------------------- */
  async function openRun(id) {
    close();
    stretch = null;
    if (!id) return "off";
    window.slowdrift.expectPlotly(); // large: fetch it while the run is asked for, not after
    const on = (run) => set("run-page", "run-live", { data: run });
    const stream = { url: `/runs/${encodeURIComponent(id)}/events`, poll: `/runs/${encodeURIComponent(id)}`, single: true, on };
    current = stream;
    const answer = await fetch(api() + stream.poll, { credentials: "same-origin" }).catch(() => null);
    if (stream !== current) return "off";
    if (!answer || !answer.ok) {
      set("run-page", "run-phase", { data: "missing" });
      return "off";
    }
    const run = await answer.json();
    on(run);
    if (FINAL.includes(run.state)) stream.ended = true;
    else start(stream);
    return "on";
  }

  function paintRun(run, phase) {
    if (!run) return Array(7).fill(nothing());
    const active = !FINAL.includes(run.state);
    const percent = Math.round(100 * (run.progress || 0));
    const words = [run.state === "queued" ? "waiting for a worker" : `${percent} %`, run.message].filter(Boolean);
    const text = [...new Set(words)].join(" · ");
    const show = (yes) => (yes ? {} : { display: "none" });
    return [
      run.state, `sd-badge sd-badge-${run.state}`, percent, text, show(active),
      show(active && run.state !== "cancelling"), run.state === phase ? nothing() : run.state,
    ];
  }

  /* The address holds what is on the screen, so that it can be sent to somebody: tab, choices, the stretch of a history. */
  let stretch = null; // {from, to} once somebody zoomed here, empty for all of it

  function address(tab, options) {
    const query = new URLSearchParams();
    if (tab && tab !== "overview") query.set("tab", tab);
    const { from, to, ...rest } = options || {};
    Object.entries(rest).forEach(([name, value]) => query.set(name, value));
    const shown = stretch || { from, to };
    if (tab === "time") Object.entries(shown).forEach(([name, value]) => value !== undefined && query.set(name, value));
    const text = query.toString();
    window.history.replaceState(window.history.state, "", window.location.pathname + (text ? `?${text}` : ""));
    return text;
  }

  function zoomed(changes, tab, options) {
    for (const change of changes || []) {
      const range = change && (change["xaxis.range"] || (change["xaxis.range[0]"] !== undefined && [change["xaxis.range[0]"], change["xaxis.range[1]"]]));
      if (range) stretch = { from: Number(range[0].toFixed(3)), to: Number(range[1].toFixed(3)) };
      else if (change && change["xaxis.autorange"]) stretch = {};
      else continue;
      address(tab, options);
    }
    return "";
  }

  /* A change of a history's layout that is about time; others say nothing of what to show. */
  function looked(change) {
    const about = change && ["xaxis.range", "xaxis.range[0]", "xaxis.autorange"].some((name) => change[name] !== undefined);
    return about ? change : nothing();
  }

  /* Every change of page: close a stream that belongs to another page. */
  function follow(pathname, prefix) {
    const inside = (pathname || "").slice((prefix || "/").length - 1).replace(/\/$/, "");
    const wanted = inside === "" ? "/events" : inside.startsWith("/runs/") ? `${inside}/events` : null;
    if (current && current.url !== wanted && !inside.startsWith("/shared/")) close();
    return {};
  }

  function navbar(opened, pathname, previous) {
    const asked = (window.dash_clientside.callback_context.triggered[0] || {}).prop_id || "";
    const open = asked.startsWith("location") ? false : Boolean(opened);
    return [{ ...previous, collapsed: { mobile: !open, desktop: true } }, open];
  }

  window.dash_clientside = window.dash_clientside || {};
  window.dash_clientside.slowdrift = Object.assign(window.dash_clientside.slowdrift || {}, {
    openRuns, openRun, paintRun, address, zoomed, looked, follow, navbar,
  });
  window.addEventListener("pagehide", stop);
})();
