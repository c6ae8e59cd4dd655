// A loop as a form: what an engineer knows of it, and the address of each tag as its bus needs it.
import { words } from "./format.js";
import { html } from "./html.js";

const ROLES = { pv: "PV, process variable", op: "OP, controller output", sp: "SP, set point", mv: "MV, valve position or flow", mode: "Mode of the controller" };
const NEEDED = ["pv", "op"];

const plainType = (schema) => schema.anyOf?.find((each) => each.type !== "null") ?? schema;

function Field({ label, schema, value, change, required }) {
  const type = plainType(schema);
  const hint = schema.default !== undefined && schema.default !== null ? String(schema.default) : schema.examples?.[0] ?? "";
  const put = (text) => change(text === "" ? null : type.type === "number" || type.type === "integer" ? Number(text) : text);
  return html`<label class="field" title=${schema.description ?? ""}>${label}${required ? " *" : ""}
    ${type.enum
      ? html`<select onChange=${(event) => put(event.target.value)}><option value="" selected=${!value}>${hint ? `default: ${hint}` : "choose"}</option>${type.enum.map((each) => html`<option value=${each} selected=${each === value}>${each}</option>`)}</select>`
      : html`<input value=${value ?? ""} placeholder=${hint} inputmode=${type.type === "number" || type.type === "integer" ? "decimal" : undefined} onInput=${(event) => put(event.target.value)} />`}</label>`;
}

export function LoopForm({ entry, isNew, connections, kinds, simple, change }) {
  const connection = connections.find((each) => each.name === entry.connection);
  const kind = kinds[connection?.kind];
  const set = (key, value) => {
    const next = { ...entry, [key]: value };
    if (value === null) delete next[key];
    change(next);
  };
  const setTag = (role, key, value) => {
    const tag = { ...(entry.tags?.[role] ?? {}), [key]: value };
    if (value === null) delete tag[key];
    const tags = { ...entry.tags, [role]: tag };
    if (Object.keys(tag).length === 0) delete tags[role];
    change({ ...entry, tags });
  };
  const publishes = (name) => (entry.publish ?? []).some((each) => each.connection === name);
  const toggle = (name) => set("publish", publishes(name) ? entry.publish.filter((each) => each.connection !== name) : [...(entry.publish ?? []), { connection: name }]);
  return html`<div class="form">
    <div class="form-row">
      <label class="field">Name *<input data-testid="loop-name" value=${entry.name} readonly=${!isNew} placeholder="FIC101" onInput=${(event) => change({ ...entry, name: event.target.value })} /></label>
      <label class="field">Read from<select onChange=${(event) => change({ ...entry, connection: event.target.value, tags: {} })}>${connections.filter((each) => kinds[each.kind]?.roles.length).map((each) => html`<option value=${each.name} selected=${each.name === entry.connection}>${each.name} (${words(each.kind)})</option>`)}</select></label>
      <${Field} label="Sampling time, s" schema=${{ type: "number" }} value=${entry.ts} required=${true} change=${(value) => set("ts", value)} />
      <${Field} label="Controller action" schema=${{ enum: ["reverse", "direct"], default: "not known" }} value=${entry.acting} change=${(value) => set("acting", value)} />
      <label class="field">PV integrates the flow<select onChange=${(event) => set("integrating", { "": null, yes: true, no: false }[event.target.value])}>
        ${[["", "not known"], ["yes", "yes, a level"], ["no", "no"]].map(([value, text]) => html`<option value=${value} selected=${{ true: "yes", false: "no" }[entry.integrating] === value}>${text}</option>`)}</select></label>
    </div>
    ${kind && kind.roles.filter((role) => ROLES[role]).map((role) => html`<fieldset class="form-row" data-tag=${role}><legend>${ROLES[role]}${NEEDED.includes(role) ? " *" : ""}</legend>
      ${Object.entries(kind.tag).map(([key, schema]) => html`<${Field} key=${key} label=${words(key)} schema=${schema} value=${entry.tags?.[role]?.[key]} required=${NEEDED.includes(role) && kind.required.includes(key)} change=${(value) => setTag(role, key, value)} />`)}</fieldset>`)}
    <fieldset class="form-row"><legend>Alarm is published on</legend>
      ${connections.filter((each) => simple.includes(each.kind) || publishes(each.name)).map((each) => html`<label class="tick"><input type="checkbox" checked=${publishes(each.name)} onChange=${() => toggle(each.name)} /> ${each.name}</label>`)}</fieldset>
    <p class="quiet">Fields with * are needed. Window, alarm and other settings: as YAML.</p></div>`;
}
