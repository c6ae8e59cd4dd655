// Workbench: the tree of steps, PV with model and residual, the residual against an axis, candidates to tick.
import { Refused, get, send, upload } from "../parts/api.js";
import { html, useCallback, useEffect, useRef, useState } from "../parts/html.js";
import { number } from "../parts/format.js";
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
  return session ? html`<${Session} key=${session} name=${session} leave=${() => navigate(url.pathname)} />` : html`<${Opening} open=${open} />`;
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
      <p class="lead">${state.loop}, ${state.samples} samples of ${number(state.ts)} s${html` · ${Object.entries(state.columns).map(([role, column]) => (role === column ? role : `${role} = ${column}`)).join(", ")}`}</p>
      <div class="actions">${model && html`<a class="button" href=${`${base}/report`} download>Report</a>`}<button type="button" onClick=${end}>Close</button></div></div>
    ${fault && html`<p class="problem" role="alert">${fault}</p>`}
    <${Columns} state=${state} busy=${busy} read=${(columns) => act("columns", { columns })} />
    <${Progress} live=${live} found=${found} />
    ${state.reason && html`<section class="card"><h2>Not testable</h2><p>${state.reason}</p></section>`}
    ${model && html`<div class="wb">
      <div class="stack wb-left">
        <section class="card"><h2>Steps</h2><${Tree} state=${state} busy=${busy} go=${(each) => act("go", { number: each })} /></section>
        <section class="card"><h2>Error</h2><${Staircase} state=${state} /></section>
        <${Same} state=${state} />
      </div>
      <div class="stack">
        <${Verdict} found=${found} base=${base} />
        <section class="card"><h2>PV, model and residual</h2>
          <${Curves} model=${model} quick=${quick} stretch=${stretch} brush=${setStretch} />
          <${Brushed} stretch=${stretch} clear=${() => setStretch(null)} busy=${busy} leaveOut=${() => act("leave-out", { start: stretch[0], end: stretch[1] }).then(() => setStretch(null))} /></section>
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
function Columns({ state, busy, read }) {
  const [own, setOwn] = useState({});
  return html`<details class="wb-columns"><summary>Other columns</summary><div class="form-row">
    ${ROLES.map((role) => html`<label class="field">${role}<input placeholder=${state.columns[role] ?? ""} value=${own[role] ?? ""} onInput=${(event) => setOwn({ ...own, [role]: event.target.value })} /></label>`)}
    </div><p class="buttons"><button type="button" disabled=${busy || !Object.values(own).some(Boolean)} onClick=${() => read(own)}>Read it again, by these columns</button></p></details>`;
}

function Progress({ live, found }) {
  if (!live?.busy) return null;
  const at = live.progress;
  return html`<p class="wb-progress" role="status"><progress max=${at?.of || 1} value=${at ? at.done : 0}></progress> ${at ? at.what : "Fitting"}${found ? "" : ": which effect is missing"}</p>`;
}

function Verdict({ found }) {
  if (!found) return null;
  const none = found.verdict.kind === "none_of_the_known";
  const pattern = found.axes[0];
  return html`<section class=${`card wb-verdict ${found.verdict.kind}`} data-testid="verdict" data-kind=${found.verdict.kind}>
    <p class="wb-headline">${found.headline}</p>
    ${found.headline !== found.verdict.words && html`<p>${found.verdict.words}.</p>`}
    ${none && html`<p><strong>None of the known effects explains it.</strong> ${pattern && html`The strongest pattern is in ${pattern.axis.replaceAll("_", " ")}: ${number(100 * pattern.share)} % of the residual, p = ${number(pattern.p)}; such a pattern is made by ${pattern.causes}. `}Write an effect of your own (docs/howto/own_effect.md) and compare with <code>--effect FILE.py:CLASS</code>.</p>`}
    <details><summary>What could not have been seen</summary><ul>${found.unseen.map((each) => html`<li>${each}</li>`)}</ul></details></section>`;
}

function Brushed({ stretch, clear, leaveOut, busy }) {
  if (!stretch) return html`<p class="quiet">Drag over a stretch: it lights up in every picture.</p>`;
  return html`<p class="buttons"><span>${number(stretch[0], 4)} to ${number(stretch[1], 4)} s</span>
    <button type="button" disabled=${busy} onClick=${leaveOut}>Leave it out and fit again</button><button type="button" onClick=${clear}>Clear</button></p>`;
}

function Same({ state }) {
  return html`<section class="card"><details><summary>The same in a shell, in Python</summary>
    <pre class="difference">${state.command}</pre><pre class="difference">${state.python}</pre>
    <p class="quiet">This address leads back to the session: ${location.href}</p></details></section>`;
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
  return html`<section class="card"><h2>Validate</h2><p class="quiet">${scored === null ? "Another recording of the loop: each step is scored on it, nothing is fitted to it." : `Error of this step on the other recording: ${number(scored)}`}</p>
    <label class="field">Other recording<input type="file" ref=${input} data-testid="validation" onChange=${chosen} /></label></section>`;
}
