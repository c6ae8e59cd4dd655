// Configure: a loop as a form or as YAML, a connection as YAML; each tag is read from the live bus before it is saved.
import { get, send } from "../parts/api.js";
import { dash, number } from "../parts/format.js";
import { html, useEffect, useState } from "../parts/html.js";
import { LoopForm } from "../parts/loop_form.js";
import { keepWho, who } from "../parts/who.js";

const TEMPLATE = "kind: mqtt\nhost: 127.0.0.1\n";
const SIMPLE = ["mqtt", "opcua_server", "modbus_server", "sparkplug"]; // kinds that publish without addresses

export default function Configure() {
  const [file, setFile] = useState(null);
  const [fault, setFault] = useState(null);
  const [chosen, choose] = useState(null);
  const load = () => get("/api/configure").then(setFile, (error) => setFault(error.message));
  useEffect(() => {
    document.title = "Configure";
    load();
  }, []);
  if (fault) return html`<h1>Configure</h1><p class="problem" role="alert">${fault}</p>`;
  if (!file) return html`<p class="loading" role="status">Loading</p>`;
  const pick = (what, each) => choose({ what, name: each?.name ?? "", isNew: !each, entry: each?.entry ?? null, yaml: each?.yaml ?? (what === "connection" ? TEMPLATE : ""), key: `${what}:${each?.name ?? `new ${Date.now()}`}` });
  return html`<div class="headline"><h1>Configure</h1><p class="lead">${file.file}. Loops and connections that you do not change go on.</p></div>
    <div class="columns configure">
      <div class="stack">${chosen ? html`<${Editor} key=${chosen.key} chosen=${chosen} file=${file} saved=${(name) => load().then(() => choose(null)) && name} />`
        : html`<section class="card"><h2>Choose what to change</h2><p class="quiet">Or add a loop: its tags are read once from the live bus before it is saved.</p>
          <button type="button" class="primary" data-testid="new-loop" onClick=${() => pick("loop", null)}>New loop</button></section>`}</div>
      <div class="stack">
        <${Entries} title="Loops" rows=${file.loops} under=${(each) => each.connection} chosen=${chosen} pick=${(each) => pick("loop", each)} add="New loop" />
        ${file.lists.length > 0 && html`<p class="quiet">Further loops come from ${file.lists.join(", ")}: change that file.</p>`}
        <${Entries} title="Connections" rows=${file.connections} under=${(each) => each.kind} chosen=${chosen} pick=${(each) => pick("connection", each)} add="New connection" />
      </div>
    </div>`;
}

function Entries({ title, rows, under, chosen, pick, add }) {
  const [search, set] = useState("");
  const shown = rows.filter((each) => each.name.toLowerCase().includes(search.toLowerCase())).slice(0, 100);
  return html`<section class="card"><h2>${title} <span class="count">${rows.length}</span></h2>
    ${rows.length > 12 && html`<label class="search"><span class="unseen">Search ${title}</span><input type="search" placeholder="Search" value=${search} onInput=${(event) => set(event.target.value)} /></label>`}
    <ul class="entries">${shown.map((each) => html`<li><button type="button" aria-pressed=${chosen?.name === each.name} onClick=${() => pick(each)}>${each.name}<span class="under">${under(each)}</span></button></li>`)}</ul>
    <button type="button" onClick=${() => pick(null)}>${add}</button></section>`;
}

function Editor({ chosen, file, saved }) {
  const { what, isNew } = chosen;
  const readable = file.connections.filter((each) => file.kinds[each.kind]?.roles.length);
  const [name, setName] = useState(chosen.name);
  const [entry, setEntry] = useState(chosen.entry ?? { name: "", connection: readable[0]?.name ?? "", ts: 1, tags: {}, publish: file.connections.filter((each) => SIMPLE.includes(each.kind)).map((each) => ({ connection: each.name })) });
  const [yaml, setYaml] = useState(chosen.yaml);
  const [form, setForm] = useState(what === "loop");
  const [checked, setChecked] = useState(null);
  const [findings, setFindings] = useState(null);
  const [by, setBy] = useState(who());
  const [busy, setBusy] = useState("");
  const [said, say] = useState(null);
  const wish = () => ({ what, name: what === "loop" && form ? entry.name : name, ...(form ? { entry } : { yaml }) });
  const changed = () => {
    setChecked(null);
    setFindings(null);
    say(null);
  };
  const work = async (doing, step) => {
    setBusy(doing);
    say(null);
    try {
      await step();
    } catch (error) {
      say({ fault: true, text: error.message });
    } finally {
      setBusy("");
    }
  };
  const check = () => work("check", async () => setChecked(await send("/api/configure/check", wish())));
  const attempt = () => work("try", async () => {
    const found = await send("/api/configure/check", wish());
    setChecked(found);
    if (!found.faults.length) setFindings((await send("/api/configure/try", wish())).findings);
  });
  const save = () => work("save", async () => {
    keepWho(by.trim());
    await send("/api/configure/save", { ...wish(), digest: checked.digest, by: by.trim() });
    say({ fault: false, text: "Saved and applied." });
    saved(wish().name);
  });
  const toYaml = () => work("check", async () => {
    const found = await send("/api/configure/check", wish());
    setYaml(found.yaml);
    setName(entry.name);
    setForm(false);
  });
  const good = checked && checked.faults.length === 0;
  return html`<section class="card"><div class="headline"><h2>${isNew ? `New ${what}` : chosen.name}</h2>
      ${what === "loop" && form && html`<div class="views"><button type="button" aria-pressed="true">Form</button><button type="button" aria-pressed="false" disabled=${!entry.name} onClick=${toYaml}>YAML</button></div>`}</div>
    ${what === "loop" && form
      ? html`<${LoopForm} entry=${entry} isNew=${isNew} connections=${file.connections} kinds=${file.kinds} simple=${SIMPLE} change=${(next) => (setEntry(next), changed())} />`
      : html`${(what === "connection" || isNew) && html`<label class="field">Name<input value=${name} readonly=${!isNew} onInput=${(event) => (setName(event.target.value), changed())} /></label>`}
        <label class="field">YAML<textarea class="code" rows="16" spellcheck="false" value=${yaml} onInput=${(event) => (setYaml(event.target.value), changed())}></textarea></label>`}
    <div class="buttons"><button type="button" disabled=${Boolean(busy)} onClick=${check}>Check</button>
      <button type="button" data-testid="try" disabled=${Boolean(busy)} onClick=${attempt}>${what === "loop" ? "Read each tag once" : "Open the connection"}</button></div>
    <p role="status" class="quiet" hidden=${!busy}>${busy === "try" ? "Reading from the bus: this may take some seconds" : "Working"}</p>
    <p role="alert" class=${said?.fault ? "problem" : "done"} hidden=${!said}>${said?.text}</p>
    ${checked && checked.faults.length > 0 && html`<ul class="problem plainlist" role="alert">${checked.faults.map((each) => html`<li>${each}</li>`)}</ul>`}
    ${findings && html`<${Findings} findings=${findings} />`}
    ${good && html`<h3>Lines of the file that change</h3><pre class="difference" tabindex="0" aria-label="Lines that change">${checked.difference.split("\n").map((line) => html`<span class=${line[0] === "+" ? "more" : line[0] === "-" ? "less" : ""}>${line}${"\n"}</span>`)}</pre>
      <div class="buttons"><label class="field">Your name<input value=${by} maxlength="80" autocomplete="name" onInput=${(event) => setBy(event.target.value)} /></label>
      <button type="button" class="primary low" data-testid="save" disabled=${Boolean(busy) || !by.trim() || !checked.difference} onClick=${save}>Save and apply</button></div>
      ${!findings && html`<p class="quiet">Not tried on the bus yet.</p>`}`}
  </section>`;
}

function Findings({ findings }) {
  if (findings.length === 0) return html`<p class="quiet">This connection listens: there is nobody to reach.</p>`;
  return html`<h3>What the bus answers</h3><div class="scroll" tabindex="0" role="group" aria-label="Table"><table><caption class="unseen">Values of the tags</caption>
    <thead><tr><th scope="col">Tag</th><th scope="col" class="number">Value</th><th scope="col">Quality</th><th scope="col">Remarks</th></tr></thead>
    <tbody>${findings.map((each) => html`<tr data-role=${each.role || "connection"}><th scope="row">${each.what === "tag" ? each.role : "connection"}</th>
      <td class="number">${each.what === "tag" ? (typeof each.value === "number" ? number(each.value, 6) : each.value ?? dash) : ""}</td><td>${each.quality ?? ""}</td>
      <td>${each.problems.map((text) => html`<div class="down-words">${text}</div>`)}${each.remarks.map((text) => html`<div class="quiet">${text}</div>`)}${each.problems.length + each.remarks.length === 0 ? "ok" : ""}</td></tr>`)}</tbody></table></div>`;
}
