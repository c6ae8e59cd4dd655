// The REST interface in words, out of its own OpenAPI description: no library of others, no other host.
import { get } from "../parts/api.js";
import { sentence } from "../parts/format.js";
import { html, useEffect, useState } from "../parts/html.js";

const typeOf = (schema) => {
  if (!schema) return "";
  if (schema.$ref) return schema.$ref.split("/").at(-1);
  if (schema.anyOf) return schema.anyOf.map(typeOf).join(" or ");
  if (schema.enum) return schema.enum.map((each) => JSON.stringify(each)).join(" | ");
  return schema.type === "array" ? `list of ${typeOf(schema.items)}` : schema.type ?? "any";
};

function Operation({ path, method, says }) {
  const body = says.requestBody?.content;
  const kind = body && Object.keys(body)[0];
  const rows = says.parameters ?? [];
  return html`<details class="operation">
    <summary><code class=${`method ${method}`}>${method.toUpperCase()}</code> <code>${path}</code> <span class="quiet">${(says.description ?? says.summary).split("\n")[0]}</span></summary>
    ${(says.description ?? "").includes("\n") && html`<p>${says.description.split("\n").slice(1).join(" ").trim()}</p>`}
    ${rows.length > 0 && html`<table><caption class="unseen">Parameters of ${path}</caption>
      <thead><tr><th scope="col">Parameter</th><th scope="col">In</th><th scope="col">Type</th><th scope="col">Meaning</th></tr></thead>
      <tbody>${rows.map((row) => html`<tr><th scope="row"><code>${row.name}</code></th><td>${row.in}</td>
        <td>${typeOf(row.schema)}</td><td>${row.description ?? ""}</td></tr>`)}</tbody></table>`}
    ${kind && html`<p>Body: <code>${kind}</code>, ${typeOf(body[kind].schema)}</p>`}
  </details>`;
}

/** Operations by the screen that they belong to. */
function byTag(paths) {
  const found = new Map();
  for (const [path, methods] of Object.entries(paths)) {
    for (const [method, says] of Object.entries(methods)) {
      const tag = says.tags?.[0] ?? "other";
      found.set(tag, [...(found.get(tag) ?? []), [path, method, says]]);
    }
  }
  return found;
}

export default function Reference() {
  const [described, set] = useState(null);
  useEffect(() => {
    document.title = "REST interface";
    get("/api/openapi.json").then(set);
  }, []);
  if (!described) return html`<p class="loading" role="status">Loading</p>`;
  const schemas = Object.entries(described.components?.schemas ?? {}).filter(([name]) => !name.includes("Validation"));
  return html`<h1>REST interface</h1>
    <p>Version ${described.info.version}. The description for programs is <a href="/api/openapi.json" target="_self">/api/openapi.json</a>.
      A request that changes state carries the header <code>X-CSRF-Token</code> with what <code>GET /api/session</code> gives,
      or <code>Authorization: Bearer TOKEN</code>.</p>
    ${[...byTag(described.paths)].map(([tag, rows]) => html`<h2 class="reference-tag">${sentence(tag)}</h2>${rows.map(([path, method, says]) =>
      html`<${Operation} key=${method + path} path=${path} method=${method} says=${says} />`)}`)}
    ${schemas.length > 0 && html`<h2>Types</h2>`}
    ${schemas.map(([name, schema]) => html`<details class="operation"><summary><code>${name}</code></summary>
      <table><caption class="unseen">Fields of ${name}</caption>
        <thead><tr><th scope="col">Field</th><th scope="col">Type</th><th scope="col">Meaning</th></tr></thead>
        <tbody>${Object.entries(schema.properties ?? {}).map(([field, says]) => html`<tr><th scope="row"><code>${field}</code></th>
          <td>${typeOf(says)}</td><td>${says.description ?? ""}</td></tr>`)}</tbody></table></details>`)}`;
}
