/* The address of the compare page holds its runs and choices, so that it can be sent to somebody. */
(function () {
  "use strict";
  function compareAddress(runs, options) {
    const query = new URLSearchParams();
    if (Array.isArray(runs) && runs.length) query.set("runs", runs.join(","));
    Object.entries(options || {}).forEach(([name, value]) => query.set(name, value));
    const text = query.toString().replaceAll("%2C", ",");
    window.history.replaceState(window.history.state, "", window.location.pathname + (text ? `?${text}` : ""));
    return text;
  }
  window.dash_clientside = window.dash_clientside || {};
  window.dash_clientside.slowdrift = Object.assign(window.dash_clientside.slowdrift || {}, { compareAddress });
})();
