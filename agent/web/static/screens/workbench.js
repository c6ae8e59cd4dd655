// Workbench: the tree of steps, PV with model and residual, the residual against an axis, candidates to tick.
import { Refused, get, send, upload } from "../parts/api.js";
import { html, useCallback, useEffect, useRef, useState } from "../parts/html.js";
import { number, sentence } from "../parts/format.js";
import { named, plainly } from "../parts/names.js";
import { navigate } from "../parts/router.js";
import { useStream } from "../parts/stream.js";
import { Candidates } from "../parts/candidates.js";
import { Curves } from "../parts/curves.js";
import { Opening } from "../parts/opening.js";
import { ResidualAxis } from "../parts/residual_axis.js";
import { Sliders } from "../parts/sliders.js";
import { Staircase, Tree } from "../parts/steps.js";

export default function Workbench({ address }) {
  const url = new URL(address, location.origin);
  const session = url.searchParams.get("session");
  const open = (name) => navigate(`${url.pathname}?session=${encodeURIComponent(name)}`);
  useEffect(() => { document.title = "Workbench"; }, []);
  return session ? html`<${Session} key=${session} name=${session} leave=${() => navigate(url.pathname)} />` : html`<${Opening} open=${open} loop=${url.searchParams.get("loop")} />`;
}

function Session({ name, leave }) {
  const base = `/api/workbench/sessions/${encodeURIComponent(name)}`;
  const [gone, setGone] = useState(null);
  const live = useStream(gone ? "" : `${base}/stream`);
  const [state, setState] = useState(null);
  const [fault, setFault] = useState(null);
  const [quick, setQuick] = useState(null); // a curve before its fit is done, or of the sliders
  const [stretch, setStretch] = useState(null);
  const version = live?.version;
  const load = useCallback(() => get(base).then((found) => { setState(found); setQuick(null); }, (error) => error.status === 404 ? setGone(error.message) : setFault(error.message)), [base]);
  useEffect(() => { if (version !== undefined) load(); }, [version]);
  useEffect(() => { get(base).catch((error) => { if (error.status === 404) setGone(error.message); }); }, [base]);
  useEffect(() => { if (live?.curve) setQuick(live.curve.pv); }, [live?.curve]);
  useEffect(() => { if (live?.ended) setGone("this session has ended; open the recording again"); }, [live?.ended]);
  const act = async (command, body) => {
    setFault(null);
    try {
      await send(`${base}/${command}`, body);
    } catch (error) {
      setFault(error instanceof Refused ? error.message : String(error));
      await load();
    }
  };
  if (gone) return html`<h1>Workbench</h1><p class="problem" role="alert">${gone}</p><p><button type="button" onClick=${leave}>Open a recording</button></p>`;
  if (!state?.nodes) return html`<p class="loading" role="status">${live?.progress ? live.progress.what : "Reading the recording"}</p>`;
  const busy = Boolean(live?.busy);
  const { model, found } = state;
  const end = async () => {
    await send(base, {}, "DELETE");
    leave();
  };
  return html`<div class="headline wb-head"><h1>${state.recording}</h1>
      <p class="lead">${state.loop}, ${state.samples} samples of ${number(state.ts)} s</p>
      <div class="actions">${model && html`<a class="button" href=${`${base}/report`} download>Report</a>`}<button type="button" onClick=${end}>Close</button></div></div>
    ${fault && html`<p class="problem" role="alert">${fault}</p>`}
    <${Columns} base=${base} state=${state} busy=${busy} read=${(columns) => act("columns", { columns })} />
    <${Progress} live=${live} found=${found} />
    ${state.reason && html`<section class="card"><h2>Not testable</h2><p>${state.reason}</p></section>`}
    ${model && html`<div class="wb">
      <div class="stack wb-left">
        <section class="card"><h2>Steps</h2><${Tree} state=${state} busy=${busy} go=${(each) => act("go", { number: each })} /></section>
        <section class="card"><h2>Held-out error</h2><${Staircase} state=${state} /></section>
        <${Same} state=${state} />
      </div>
      <div class="stack">
        <${Verdict} found=${found} base=${base} />
        <section class="card"><h2>PV, model and residual</h2>
          <${Curves} model=${model} quick=${quick} stretch=${stretch} brush=${setStretch} />
          <${Brushed} stretch=${stretch} brush=${setStretch} clear=${() => setStretch(null)} busy=${busy} leaveOut=${() => act("leave-out", { start: stretch[0], end: stretch[1] }).then(() => setStretch(null))} /></section>
        <${ResidualAxis} base=${base} state=${state} stretch=${stretch} />
      </div>
      <div class="stack">
        <${Candidates} state=${state} busy=${busy} tick=${(effect) => act("tick", { effect })} untick=${(effect) => act("untick", { effect })} />
        <${Sliders} base=${base} state=${state} busy=${busy} show=${setQuick} fit=${(values) => act("fit-from", { values })} />
        <${Validation} session=${name} state=${state} fault=${setFault} />
      </div></div>`}`;
}

const ROLES = ["time", "OP", "PV", "SP"];

/** The columns that were recognised, to be corrected. */
function Columns({ base, state, busy, read }) {
  const [own, setOwn] = useState({});
  const [names, setNames] = useState(null);
  const look = (event) => {
    if (event.target.open && !names) get(`${base}/columns`).then(setNames, () => setNames([]));
  };
  return html`<details class="wb-columns" onToggle=${look}><summary>Columns: ${Object.entries(state.columns).map(([role, column]) => html`<span class="tag">${role}${role === column ? "" : ` = ${column}`}</span> `)} <span class="quiet">change</span></summary>
    ${names ? html`<div class="form-row">
      ${ROLES.map((role) => html`<label class="field">${role === "time" ? "Time" : role}<select data-role=${role.toLowerCase()} onChange=${(event) => setOwn({ ...own, [role]: event.target.value })}>
        <option value="">${state.columns[role] ? `as it is: ${state.columns[role]}` : "recognise it"}</option>${names.map((each) => html`<option value=${each}>${each}</option>`)}</select></label>`)}
    </div><p class="buttons"><button type="button" disabled=${busy || !Object.values(own).some(Boolean)} onClick=${() => read(own)}>Read it again by these columns</button><span class="quiet">Its steps begin anew.</span></p>`
      : html`<p class="quiet" role="status">Reading the header</p>`}</details>`;
}

function Progress({ live, found }) {
  const at = live?.progress;
  return html`<p class=${`wb-progress ${live?.busy ? "" : "resting"}`} role="status">${live?.busy ? html`<progress max=${at?.of || 1} value=${at ? at.done : undefined}></progress> ${at ? `${sentence(plainly(at.what))}${at.of > 1 ? `, ${at.done} of ${at.of}` : ""}` : "Fitting"}${found ? "" : ": which effect is missing"}` : html`<span class="quiet">Ready</span>`}</p>`;
}

function Verdict({ found }) {
  if (!found) return null;
  const none = found.verdict.kind === "none_of_the_known";
  const pattern = found.axes[0];
  return html`<section class=${`card wb-verdict ${found.verdict.kind}`} data-testid="verdict" data-kind=${found.verdict.kind}>
    <p class="wb-headline">${none ? "None of the known effects explains it" : sentence(plainly(found.headline))}</p>
    ${!none && found.headline !== found.verdict.words && html`<p>${sentence(plainly(found.verdict.words))}.</p>`}
    ${none && html`<p>${sentence(plainly(found.verdict.words))}.</p>
      ${pattern && html`<p><strong>The strongest pattern of the residual</strong> is in ${named(pattern.axis).toLowerCase()}: ${number(100 * pattern.share)} % of it, p = ${number(pattern.p, 2)}. Such a pattern is made by ${plainly(pattern.causes)}.</p>`}
      <p><strong>Write an effect of your own:</strong> a class with its parameters and a step function in one file, then <code>slipjump compare RECORDING --effect FILE.py:CLASS</code>. docs/howto/own_effect.md has an example of 30 lines.</p>`}
    <details><summary>What could not have been seen</summary><ul class="plainlist">${found.unseen.map((each) => html`<li>${sentence(plainly(each))}</li>`)}</ul></details></section>`;
}

function Brushed({ stretch, brush, clear, leaveOut, busy }) {
  const end = (k) => html`<input type="number" step="any" class="short" aria-label=${k ? "End of the stretch, s" : "Begin of the stretch, s"} value=${stretch ? Number(stretch[k].toPrecision(6)) : ""}
    onChange=${(event) => event.target.value !== "" && brush(k ? [Math.min(stretch?.[0] ?? 0, Number(event.target.value)), Number(event.target.value)] : [Number(event.target.value), Math.max(stretch?.[1] ?? 0, Number(event.target.value))])} />`;
  if (!stretch) return html`<p class="buttons quiet hint"><span>Drag over a stretch, or enter it: it lights up in every picture.</span><label class="beside">${end(0)} to ${end(1)} s</label></p>`;
  return html`<p class="buttons"><label class="beside">${end(0)} to ${end(1)} s</label>
    <button type="button" disabled=${busy} onClick=${leaveOut}>Leave it out and fit again</button><button type="button" onClick=${clear}>Clear</button></p>`;
}

function Same({ state }) {
  return html`<section class="card"><details><summary>The same in a shell, in Python</summary>
    <${Copied} text=${state.command} what="command" /><${Copied} text=${state.python} what="lines of Python" /></details>
    <div class="buttons"><${CopyButton} text=${location.href} what="permalink" label="Copy the permalink" /></div>
    <p class="quiet">The address leads back here until the session ends: half an hour after nobody used it.</p></section>`;
}

function Copied({ text, what }) {
  return html`<div class="copied"><pre class="difference" tabindex="0" aria-label=${what}>${text}</pre><${CopyButton} text=${text} what=${what} label="Copy" /></div>`;
}

function CopyButton({ text, what, label }) {
  const [said, say] = useState("");
  const copy = () => navigator.clipboard.writeText(text).then(() => say("Copied"), () => say("Select and copy it by hand"));
  return html`<button type="button" class="small" onClick=${copy}>${said || label}<span class="unseen"> ${what}</span></button>`;
}

function Validation({ session, state, fault }) {
  const input = useRef(null);
  const chosen = async () => {
    const file = input.current.files[0];
    if (!file) return;
    try {
      await upload(`/api/workbench/validation?session=${encodeURIComponent(session)}&name=${encodeURIComponent(file.name)}`, file);
    } catch (error) {
      fault(error.message);
    }
  };
  const scored = state.nodes[state.current].rmse_validation;
  return html`<section class="card"><h2>Validate</h2>
    ${scored === null ? html`<p class="quiet">Another recording of the loop: each step is scored on it, nothing is fitted to it.</p>`
      : html`<table class="pairs"><caption class="unseen">Error of each step on the other recording</caption><thead><tr><th scope="col">Step</th><th scope="col" class="number">RMSE, PV units</th></tr></thead>
        <tbody>${state.path.map((each) => state.nodes[each]).map((each) => html`<tr><th scope="row">${sentence(plainly(each.name))}</th><td class="number">${number(each.rmse_validation)}</td></tr>`)}</tbody></table>`}
    <label class="field">Other recording<input type="file" ref=${input} data-testid="validation" onChange=${chosen} /></label></section>`;
}
