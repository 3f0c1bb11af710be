// A certified OpenID provider (oidc-provider from npm) for tests/access/test_oidc.py. Arguments: port, and the address to
// which it sends people back. Whoever signs in says by the login who they are: subject/e-mail/verified, or .../unverified.
// A code of the client `hasty` is good for a second.
import Provider from "oidc-provider";

const [port, back, after] = process.argv.slice(2);
const client = (client_id) => ({
  client_id, client_secret: "a secret of the test's own", redirect_uris: [back], post_logout_redirect_uris: [after],
});
const provider = new Provider(`http://127.0.0.1:${port}`, {
  clients: [client("slowdrift"), client("hasty")],
  claims: { openid: ["sub"], email: ["email", "email_verified"], profile: ["name"] },
  pkce: { methods: ["S256"], required: () => true },
  ttl: { AuthorizationCode: (_, __, { clientId }) => (clientId === "hasty" ? 1 : 60) },
  features: { devInteractions: { enabled: true }, rpInitiatedLogout: { enabled: true } },
  async findAccount(_, id) {
    const [sub, email, word] = id.split("/");
    return { accountId: id, claims: async () => ({ sub: id, email, email_verified: word === "verified", name: sub }) };
  },
});
provider.listen(Number(port), "127.0.0.1", () => console.log("listening"));
