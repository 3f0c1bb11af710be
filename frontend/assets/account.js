/* Signing in and out: only the browser itself can get the session's cookie. Who is signed in stands in the header's corner. */
(function () {
  "use strict";
  const API = "/api/v1";
  const OPEN = ["sign-in", "shared", "invitations"]; // pages for those who are not signed in
  const JSON_BODY = { "content-type": "application/json" };
  const nothing = () => window.dash_clientside.no_update;
  const link = (text, href) => ({
    namespace: "dash_html_components", type: "A", props: { children: text, href, className: "sd-nav-link" },
  });

  async function ask(path, method, body) {
    try {
      const answer = await fetch(API + path, {
        method, credentials: "same-origin", headers: body ? JSON_BODY : {}, body: body ? JSON.stringify(body) : undefined,
      });
      const found = answer.status === 204 ? {} : await answer.json().catch(() => ({}));
      if (answer.ok) return [found, null];
      const fields = (found.errors || []).map((entry) => `${entry.field || ""} ${entry.message || ""}`.trim());
      return [null, [found.detail || found.title || "It did not work.", ...fields].join(" ")];
    } catch (error) {
      return [null, "The service does not answer. Try again."];
    }
  }

  /* Every change of page: who is it, and may they be here? */
  async function corner(pathname, prefix) {
    const inside = (pathname || "").slice((prefix || "/").length).split("/")[0];
    const [state] = await ask("/auth", "GET");
    if (!state || !state.accounts) return [];
    if (!state.signed_in) {
      if (OPEN.includes(inside)) return inside === "sign-in" ? [] : [link("Sign in", `${prefix}sign-in`)];
      const here = window.location.pathname + window.location.search;
      window.location.replace(`${prefix}sign-in?next=${encodeURIComponent(here)}`);
      return [];
    }
    const [me] = await ask("/me", "GET");
    return me && me.user ? [link(me.user.name || me.user.email, `${prefix}account`)] : [];
  }

  /* Only addresses of our own pages: a link from elsewhere must not lead on to a stranger. */
  function inner(next, prefix) {
    return typeof next === "string" && next.startsWith(prefix) && !next.startsWith("//") ? next : prefix;
  }

  async function signIn(clicks, submits, email, password, next, prefix) {
    if (!clicks && !submits) return nothing();
    const [, fault] = await ask("/auth/sign-in", "POST", { email: email || "", password: password || "" });
    if (fault) return fault;
    window.location.assign(inner(next, prefix));
    return "";
  }

  /* The way to the OpenID Connect provider, where the service has one. */
  async function provider(next, prefix) {
    const [state] = await ask("/auth", "GET");
    if (!state || !state.provider) return [];
    const href = `${API}/auth/oidc/start?next=${encodeURIComponent(inner(next, prefix))}`;
    const props = { children: `Sign in with ${state.provider}`, href, className: "sd-button sd-button-default" };
    return [{ namespace: "dash_html_components", type: "A", props }];
  }

  async function signOut(clicks, prefix) {
    if (!clicks) return nothing();
    const [me] = await ask("/me", "GET");
    const [, fault] = await ask("/auth/sign-out", "POST", { everywhere: false });
    if (!fault) window.location.assign(me && me.by_provider ? `${API}/auth/oidc/sign-out` : `${prefix}sign-in`);
    return fault || "";
  }

  async function accept(clicks, token, email, name, password, prefix) {
    if (!clicks) return nothing();
    const body = {};
    Object.entries({ email, name, password }).forEach(([key, value]) => value && (body[key] = value));
    const [, fault] = await ask(`/invitations/${encodeURIComponent(token)}/accept`, "POST", body);
    if (fault) return fault;
    window.location.assign(prefix);
    return "";
  }

  window.dash_clientside = window.dash_clientside || {};
  window.dash_clientside.slowdrift = Object.assign(window.dash_clientside.slowdrift || {}, { corner, signIn, signOut, provider, accept });
})();
