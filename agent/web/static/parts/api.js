// The REST interface: JSON in, JSON out, the CSRF token with each request that changes state.
let session = null;

export class Refused extends Error {
  constructor(status, detail, more = {}) {
    super(detail);
    this.status = status;
    this.columns = more.columns ?? []; // of a file whose columns nobody recognised
  }
}

export async function openSession() {
  session = await get("/api/session");
  return session;
}

export async function get(path, signal) {
  return answered(await fetch(path, { signal, headers: { Accept: "application/json" } }));
}

/** Sends a request that changes state; ``body`` is JSON, or FormData for uploads. */
export async function send(path, body, method = "POST") {
  const form = body instanceof FormData;
  const go = () =>
    fetch(path, {
      method,
      headers: { "X-CSRF-Token": session.csrf, ...(form ? {} : { "Content-Type": "application/json" }) },
      body: form ? body : JSON.stringify(body ?? {}),
    });
  let answer = await go();
  if (answer.status === 403) {
    // The server was started anew since this page was loaded: its tokens are others now.
    await openSession();
    answer = await go();
  }
  return answered(answer);
}

/** Sends a file as the body. */
export async function upload(path, file) {
  return answered(await fetch(path, { method: "POST", headers: { "X-CSRF-Token": session.csrf, "Content-Type": "application/octet-stream" }, body: file }));
}

async function answered(answer) {
  if (answer.status === 401) location.reload();
  if (answer.ok) return answer.status === 204 ? null : answer.json();
  const text = await answer.text();
  let detail = text || answer.statusText;
  let more = {};
  try {
    more = JSON.parse(text);
    const said = more.detail;
    detail = typeof said === "string" ? said : said.map((each) => `${each.loc.at(-1)}: ${each.msg}`).join("; ");
  } catch { /* not JSON: the text itself is the reason */ }
  throw new Refused(answer.status, detail, more);
}
