// Begin: a recording from this machine, a window of the plant, or a session that is open.
import { get, send, upload } from "./api.js";
import { html, useEffect, useState } from "./html.js";

const ROLES = ["time", "op", "pv", "sp"];
const NEEDED = ["op", "pv"];
const MOST = 200; // loops that are listed at a time

/** ``loop``: open its window at once. */
export function Opening({ open, loop }) {
  const [known, setKnown] = useState(null);
  const [busy, setBusy] = useState("");
  const [fault, setFault] = useState(null);
  const [loops, setLoops] = useState([]);
  const [search, setSearch] = useState("");
  const [asked, setAsked] = useState(null); // a file whose columns nobody recognised
  const [over, setOver] = useState(false);
  useEffect(() => {
    let timer = 0;
    let left = false;
    const look = () => get("/api/workbench/sessions").then((found) => {
      if (left) return;
      setKnown(found);
      if (found.live) get("/api/loops").then(setLoops, () => setLoops([]));
      else if (!found.sessions.length) timer = setTimeout(look, 2000); // one that the command line opens
    }, (error) => { if (!left) setFault(error.message); });
    look();
    if (loop) live(loop);
    return () => {
      left = true;
      clearTimeout(timer);
    };
  }, []);
  const begin = async (what, work, file = null) => {
    setBusy(what);
    setFault(null);
    setAsked(null);
    try {
      open((await work()).session);
    } catch (error) {
      setFault(error.message);
      if (file && error.columns.length) setAsked({ file, columns: error.columns });
    }
    setBusy("");
  };
  const live = (name) => begin(name, () => send(`/api/workbench/loops/${encodeURIComponent(name)}`));
  const read = (file, own = {}) => {
    if (known && file.size > known.largest) setFault(`${file.name} has ${Math.round(file.size / 1048576)} MB, at most ${Math.round(known.largest / 1048576)} MB are taken: cut out a stretch`);
    else begin(file.name, () => upload(`/api/workbench/sessions?${new URLSearchParams({ name: file.name, ...own })}`, file), file);
  };
  const dropped = (event) => {
    event.preventDefault();
    setOver(false);
    const file = event.dataTransfer?.files[0];
    if (file && !busy) read(file);
  };
  const fitting = loops.filter((each) => each.toLowerCase().includes(search.toLowerCase()));
  return html`<div class="headline"><h1>Workbench</h1>
    <p class="lead">Compare a model with a recording, see where it fails, tick the missing effect, watch the error fall.</p></div>
    ${fault && html`<p class="problem" role="alert" data-testid="fault">${fault}</p>`}
    ${asked && html`<${Roles} file=${asked.file} columns=${asked.columns} read=${(own) => read(asked.file, own)} />`}
    <div class="opening">
      <label class=${`drop ${over ? "over" : ""}`} onDragOver=${(event) => (event.preventDefault(), setOver(true))} onDragLeave=${() => setOver(false)} onDrop=${dropped}>
        <svg viewBox="0 0 48 32" width="72" height="48" aria-hidden="true"><path d="M2 26h10l3-18h10l3 18h10l3-18h5" class="drop-line" /></svg>
        <strong>${busy ? `Opening ${busy}` : "Open a recording"}</strong>
        <span class=${busy ? "quiet working" : "quiet"} role="status">${busy ? "Reading it and fitting the first model" : "Drop a file here, or choose one: CSV, Excel, Parquet or MAT-file with time, OP and PV"}</span>
        <input type="file" data-testid="upload" aria-label="Recording: CSV, Excel, Parquet or MAT-file with time, OP and PV" disabled=${Boolean(busy)} onChange=${(event) => event.target.files[0] && read(event.target.files[0])} />
      </label>
      <div class="stack">
        ${known?.sessions.length > 0 && html`<section class="card"><h2>Go on with a session</h2>
          <ul class="entries">${known.sessions.map((each) => html`<li><button type="button" onClick=${() => open(each.session)}>${each.recording ?? "being read"} <span class="under">open ›</span></button></li>`)}</ul></section>`}
        ${known?.live && html`<section class="card"><h2>The newest window of a loop</h2>
          ${loops.length > 12 && html`<input type="search" placeholder="Search loops" aria-label="Search loops" value=${search} onInput=${(event) => setSearch(event.target.value)} />`}
          <ul class="entries">${fitting.slice(0, MOST).map((each) => html`<li><button type="button" disabled=${Boolean(busy)} onClick=${() => live(each)}>${each} <span class="under">open ›</span></button></li>`)}</ul></section>`}
        <section class="card"><h2>How it goes</h2><ol class="steps">
          <li>A first model is fitted: PV from OP alone. What it cannot explain is the residual.</li>
          <li>The residual against level, direction, travel or time shows where the model fails.</li>
          <li>Each known effect is tried. Tick one, and the error falls toward the noise floor, or it does not.</li></ol></section>
      </div></div>`;
}

/** Which column has which role, where nobody recognised them. */
function Roles({ file, columns, read }) {
  const [own, setOwn] = useState({});
  const chosen = Object.fromEntries(Object.entries(own).filter(([, column]) => column));
  return html`<section class="card" data-testid="roles"><h2>Which columns are they?</h2>
    <p class="quiet">${file.name} has ${columns.length} columns.</p><div class="form-row">
      ${ROLES.map((role) => html`<label class="field">${role === "time" ? "Time" : role.toUpperCase()}${NEEDED.includes(role) ? " *" : ""}<select data-role=${role} onChange=${(event) => setOwn({ ...own, [role]: event.target.value })}>
        <option value="">recognise it</option>${columns.map((each) => html`<option value=${each}>${each}</option>`)}</select></label>`)}
      <label class="field">Sampling time, s<input type="number" min="0" step="any" inputmode="decimal" placeholder="by the time column" data-role="ts" onInput=${(event) => setOwn({ ...own, ts: event.target.value })} /></label>
    </div><p class="buttons"><button type="button" class="primary" disabled=${!NEEDED.every((role) => chosen[role])} onClick=${() => read(chosen)}>Read it by these columns</button></p></section>`;
}
