// One loop: live trend, model, verdict with its reasons, what to do next, decisions, history.
import { get } from "../parts/api.js";
import { Chart } from "../parts/chart.js";
import { Decision } from "../parts/decision.js";
import { dash, moment, number, percent, sentence, when, words } from "../parts/format.js";
import { History } from "../parts/history.js";
import { html, useEffect, useMemo, useState } from "../parts/html.js";
import { AlarmMark, Shape } from "../parts/marks.js";
import { Methods } from "../parts/methods.js";
import { plainly } from "../parts/names.js";
import { Plane, ValveMap } from "../parts/plane.js";
import { useStream } from "../parts/stream.js";
import { JudgedWindow, Trend } from "../parts/trend.js";

const PERIODS = 8; // of OP against PV that are drawn

export default function Loop({ params }) {
  const name = params.name;
  const base = `/api/loops/${encodeURIComponent(name)}`;
  const parts = useStream(`${base}/stream`);
  const [about, setAbout] = useState(null);
  const [fault, setFault] = useState(null);
  const [model, setModel] = useState(null);
  const [history, setHistory] = useState([]);
  const [changed, change] = useState(0);
  const judged = parts?.judged;
  const alarm = parts?.row?.alarm;
  useEffect(() => {
    document.title = name;
    const stop = new AbortController();
    get(base, stop.signal).then((found) => (setFault(null), setAbout(found)), (error) => stop.signal.aborted || setFault(error.message));
    get(`${base}/history`, stop.signal).then(setHistory, () => {});
    return () => stop.abort();
  }, [name, judged, alarm, changed]);
  const start = about?.window?.start;
  useEffect(() => {
    if (start === undefined) {
      setModel(null);
      return undefined;
    }
    const stop = new AbortController();
    get(`${base}/model`, stop.signal).then(setModel, () => {});
    return () => stop.abort();
  }, [name, start]);
  if (fault) return html`<p class="crumb"><a href="/">Work list</a></p><h1>${name}</h1><p class="problem" role="alert">${fault}</p>`;
  if (!about) return html`<p class="loading" role="status">Loading ${name}</p>`;
  const row = parts?.row ?? about.row;
  const diagnosis = about.diagnosis;
  const shown = diagnosis?.stiction?.s?.value !== null && diagnosis?.verdict !== "no_stiction";
  return html`
    <p class="crumb"><a href="/">Work list</a> <span aria-hidden="true">›</span> <a href=${`/?area=${encodeURIComponent(row.area)}`}>Area ${row.area}</a></p>
    <div class="loop-head">
      <h1>${name}</h1>
      <span class=${`verdict-words ${row.group}`} data-verdict=${row.verdict}><${Shape} group=${row.group} size=${20} /> ${row.words}</span>
      ${row.alarm !== "normal" && html`<${AlarmMark} row=${row} />`}
      ${parts?.busy && html`<span class="quiet working" role="status">A new window is being judged</span>`}
      <${Actions} name=${name} base=${base} about=${about} />
    </div>
    ${row.judgement && html`<p class="judgement" data-testid="judgement"><strong>${row.judgement.by}</strong> says: ${row.judgement.judgement === "sticks" ? "it sticks" : "it is sound"} (${moment(row.judgement.time)}). ${row.judgement.comment}</p>`}
    <${Facts} row=${row} diagnosis=${diagnosis} />
    <div class="columns">
      <div class="stack">
        <section class="card"><h2>Live</h2><${Trend} base=${base} newest=${parts?.newest} roles=${about.settings.roles} model=${model} /></section>
        ${model && html`<section class="card"><h2>Judged window and its model</h2><${JudgedWindow} model=${model} diagnosis=${diagnosis} /></section>`}
        ${diagnosis && html`<section class="card"><h2>Why</h2><ul class="plainlist">${diagnosis.reasons.map((each) => html`<li>${sentence(plainly(each))}</li>`)}</ul><${Methods} base=${base} methods=${diagnosis.methods} /></section>`}
        ${model && shown && html`<div class="grid">${model.profile && html`<section class="card"><h2>How sure is S</h2><${Profile} profile=${model.profile} s=${diagnosis.stiction.s} /></section>`}
          <section class="card"><h2>Which valves explain it</h2><${OnDemandMap} base=${base} start=${start} key=${name} /></section></div>`}
        <section class="card"><h2>History</h2><${History} entries=${history} /></section>
      </div>
      <div class="stack">
        <section class="card"><h2>What to do next</h2>${diagnosis?.advice.length ? html`<ol class="steps">${diagnosis.advice.map((each) => html`<li>${sentence(each)}</li>`)}</ol>`
          : html`<p class="quiet">${diagnosis ? "Nothing: this loop needs nobody." : "Wait for the first verdict."}</p>`}</section>
        <section class="card"><h2>Decide</h2><${Decision} row=${row} decided=${() => change((k) => k + 1)} /></section>
        ${model && html`<section class="card"><h2>PV against OP</h2><${Limits} model=${model} period=${diagnosis?.oscillation?.period_s} /></section>`}
        <section class="card"><h2>Settings and data</h2><${Settings} about=${about} /></section>
      </div>
    </div>`;
}

function Actions({ name, base, about }) {
  return html`<div class="actions">
    <details class="menu"><summary class="button">Download</summary><div class="menu-items">
      <a href=${`${base}/window.csv`} download=${`${name}.csv`}>Window, CSV</a>
      ${about.diagnosis && html`<a href=${`${base}/report`} target="_blank" rel="noopener">Report, to print</a><a href=${`${base}/work-order`} target="_blank" rel="noopener">Work order</a>`}
      ${about.window && html`<a href=${`${base}/figure.svg`} download=${`${name}.svg`}>Figure, SVG</a>`}</div></details>
    <a class="button" href=${`/workbench?loop=${encodeURIComponent(name)}`}>Open in the workbench</a></div>`;
}

function Facts({ row, diagnosis }) {
  const stiction = diagnosis?.stiction;
  const estimate = (each) => (each?.value === null || each === undefined ? dash : html`${number(each.value)}<small>${each.low === null ? "no interval" : `${number(each.low)} to ${number(each.high)}`}</small>`);
  return html`<dl class="facts card">
    <div><dt>S, OP units</dt><dd>${estimate(stiction?.s)}</dd></div>
    <div><dt>Slip jump J, OP units</dt><dd>${estimate(stiction?.j)}</dd></div>
    <div><dt>Probability that it sticks</dt><dd>${percent(row.probability)}<small>${diagnosis?.confidence ? `verdict ${percent(diagnosis.confidence)} sure` : ""}</small></dd></div>
    <div><dt>Cause</dt><dd>${sentence(words(diagnosis?.cause)) || dash}<small>${words(diagnosis?.class)}</small></dd></div>
    <div><dt>Period</dt><dd>${diagnosis?.oscillation?.period_s ? `${number(diagnosis.oscillation.period_s)} s` : dash}<small>${diagnosis?.oscillation?.detected ? "oscillates" : ""}</small></dd></div>
    <div><dt>Since</dt><dd title=${moment(row.since)}>${when(row.since)}</dd></div>
    ${row.until && html`<div><dt>Shelved until</dt><dd title=${moment(row.until)}>${when(row.until)}</dd></div>`}
    ${row.by && html`<div><dt>Decided by</dt><dd>${row.by}</dd></div>`}
  </dl>`;
}

/** The newest periods of PV against OP: more of them hide each other. */
function Limits({ model, period }) {
  const count = period ? Math.min(model.pv.length, Math.ceil((PERIODS * period) / model.ts)) : model.pv.length;
  const newest = (values) => values?.slice(-count);
  return html`<${Plane} op=${newest(model.op)} pv=${newest(model.pv)} model=${newest(model.model_pv)} />
    <ul class="key"><li><i class="measured"></i>measured</li>${model.model_pv && html`<li><i class="model"></i>model</li>`}${count < model.pv.length && html`<li>newest ${PERIODS} periods</li>`}</ul>`;
}

function Profile({ profile, s }) {
  const data = useMemo(() => [profile.s, profile.p, profile.s.map(() => profile.limit)], [profile]);
  const inside = profile.s.filter((_, k) => profile.p[k] >= profile.limit);
  const known = s.low !== null && s.high !== null;
  const ends = [...inside, s.value, ...(known ? [s.low, s.high] : [])];
  const [low, high] = [Math.min(...ends), Math.max(...ends)];
  const width = Math.max(high - low, 0.02 * high);
  const spans = useMemo(() => (known ? [{ from: s.low, to: s.high, colour: "bar" }] : []), [s.low, s.high]);
  const near = [Math.max(low - 0.5 * width, profile.s[0]), Math.min(high + 0.5 * width, profile.s.at(-1))];
  const text = known ? `S is between ${number(s.low)} and ${number(s.high)} OP units with 90 % probability (grey)` : "This record gives no interval of S";
  return html`<${Chart} data=${data} height=${190} x=${{ label: "S, OP units", range: near }} y=${{ label: "p of the best model", range: [-0.05, 1.05] }} spans=${spans}
    lines=${[{ label: "best model at this S", colour: "measured", width: 1.6, points: 4 }, { label: "limit of the interval", colour: "model", dash: [5, 4] }]} text=${text} />
    <p class="quiet">${text}. It is wider than what cannot be distinguished from the best: a margin stands for friction that the model does not have.</p>`;
}

function OnDemandMap({ base, start }) {
  const [state, set] = useState(null);
  const load = () => {
    set("waiting");
    get(`${base}/map`).then((map) => set({ map, start }), (error) => set({ fault: error.message }));
  };
  if (state === "waiting") return html`<p class="quiet working" role="status">A worker tries every valve</p>`;
  if (state?.fault) return html`<p class="problem" role="alert">${state.fault}</p>`;
  return html`${state?.map ? html`<${ValveMap} map=${state.map} />` : html`<p class="quiet">The error of every valve as a contour map over f_S and f_D. It takes a worker some seconds.</p>`}
    ${(!state || state.start !== start) && html`<button type="button" onClick=${load}>${state ? "Compute for the newest window" : "Compute the map"}</button>`}`;
}

function Settings({ about }) {
  const { settings, counters, row } = about;
  const rows = [["Bus", `${row.bus}, connection ${row.connection}`], ["Sampling time", `${number(settings.ts)} s`], ["Controller action", settings.acting ?? "not known"], ["Reads", settings.roles.map((each) => each.toUpperCase()).join(", ")],
    ["Range of OP", settings.op_range ? settings.op_range.map((each) => number(each)).join(" to ") : "not known"], ["Alarm comes after", windows(settings.on_delay)], ["Alarm goes after", windows(settings.off_delay)],
    ["Samples", `${counters.samples}, ${counters.bad} bad`], ["Gaps in the window", counters.gaps]];
  return html`<table class="pairs"><caption class="unseen">Settings and counters</caption><tbody>${rows.map(([key, value]) => html`<tr><th scope="row" class="quiet">${key}</th><td>${value}</td></tr>`)}</tbody></table>`;
}

const windows = (count) => `${count} ${count === 1 ? "window" : "windows"}`;
