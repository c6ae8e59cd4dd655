// One loop: live trend, model, verdict with its reasons, what to do next, decisions, history.
import { get } from "../parts/api.js";
import { Chart } from "../parts/chart.js";
import { Decision } from "../parts/decision.js";
import { dash, duration, moment, number, percent, words } from "../parts/format.js";
import { html, useEffect, useMemo, useRef, useState } from "../parts/html.js";
import { AlarmMark, Shape } from "../parts/marks.js";
import { Plane, ValveMap } from "../parts/plane.js";
import { useStream } from "../parts/stream.js";

export default function Loop({ params }) {
  const name = params.name;
  const base = `/api/loops/${encodeURIComponent(name)}`;
  const parts = useStream(`${base}/stream`);
  const [about, setAbout] = useState(null);
  const [fault, setFault] = useState(null);
  const [model, setModel] = useState(null);
  const [history, setHistory] = useState([]);
  const judged = parts?.judged;
  const alarm = parts?.row?.alarm;
  useEffect(() => {
    document.title = name;
    const stop = new AbortController();
    get(base, stop.signal).then((said) => (setFault(null), setAbout(said)), (error) => stop.signal.aborted || setFault(error.message));
    get(`${base}/history`, stop.signal).then(setHistory, () => {});
    return () => stop.abort();
  }, [name, judged, alarm]);
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
    <p class="crumb"><a href="/">Work list</a> / ${row.area} / ${row.connection}</p>
    <div class="loop-head">
      <h1>${name}</h1>
      <span class=${`verdict-words ${row.group}`} data-verdict=${row.verdict}><${Shape} group=${row.group} size=${20} /> ${row.words}</span>
      ${row.alarm !== "normal" && html`<${AlarmMark} row=${row} />`}
      ${parts?.busy && html`<span class="quiet" role="status">a new window is judged</span>`}
      <div class="actions"><a class="button" href=${`${base}/window.csv`} download=${`${name}.csv`}>Window as CSV</a>
        ${diagnosis && html`<a class="button" href=${`${base}/report`} target="_blank" rel="noopener">Report</a>
          <a class="button" href=${`${base}/work-order`} target="_blank" rel="noopener">Work order</a>`}
        ${about.window && html`<a class="button" href=${`${base}/figure.svg`} download=${`${name}.svg`}>Figure</a>`}
        <a class="button" href="/workbench">Workbench</a></div>
    </div>
    ${row.judgement && html`<p class="judgement" data-testid="judgement"><strong>${row.judgement.by}</strong> says: ${row.judgement.judgement === "sticks" ? "it sticks" : "it is sound"} (${moment(row.judgement.time)}). ${row.judgement.comment}</p>`}
    <${Facts} row=${row} diagnosis=${diagnosis} />
    <div class="columns">
      <div class="stack">
        <section class="card"><h2>Now</h2><${Trend} base=${base} newest=${parts?.newest} roles=${about.settings.roles} /></section>
        ${model && html`<section class="card"><h2>The window that was judged, and its model</h2><${Model} model=${model} diagnosis=${diagnosis} /></section>`}
        ${diagnosis && html`<section class="card"><h2>Why</h2><${Reasons} diagnosis=${diagnosis} /><${Methods} base=${base} methods=${diagnosis.methods} /></section>`}
        <section class="card"><h2>History</h2><${History} entries=${history} /></section>
      </div>
      <div class="stack">
        <section class="card"><h2>What to do next</h2>${diagnosis?.advice.length ? html`<ol class="steps">${diagnosis.advice.map((each) => html`<li>${each}</li>`)}</ol>` : html`<p class="quiet">Nothing.</p>`}</section>
        <section class="card"><h2>Decide</h2><${Decision} row=${row} /></section>
        ${model && html`<section class="card"><h2>PV against OP</h2><${Plane} op=${model.op} pv=${model.pv} model=${model.model_pv} />
          <ul class="key"><li><i class="measured"></i>measured</li><li><i class="model"></i>model</li></ul></section>`}
        ${model?.profile && shown && html`<section class="card"><h2>What the record says of S</h2><${Profile} profile=${model.profile} /></section>`}
        ${model && shown && html`<section class="card"><h2>Which valves explain it</h2><${OnDemandMap} base=${base} start=${start} key=${name} /></section>`}
        <section class="card"><h2>Loop</h2><${Settings} about=${about} /></section>
      </div>
    </div>`;
}

function Facts({ row, diagnosis }) {
  const stiction = diagnosis?.stiction;
  const estimate = (each) => (each?.value === null || each === undefined ? dash : html`${number(each.value)}<small>${each.low === null ? "no interval" : `${number(each.low)} to ${number(each.high)}`}</small>`);
  return html`<dl class="facts card">
    <div><dt>S, OP units</dt><dd>${estimate(stiction?.s)}</dd></div>
    <div><dt>J, OP units</dt><dd>${estimate(stiction?.j)}</dd></div>
    <div><dt>Sticks with probability</dt><dd>${percent(row.probability)}<small>${diagnosis?.confidence ? `confidence of the verdict ${percent(diagnosis.confidence)}` : ""}</small></dd></div>
    <div><dt>Cause</dt><dd>${words(diagnosis?.cause) || dash}<small>${words(diagnosis?.class)}</small></dd></div>
    <div><dt>Period</dt><dd>${diagnosis?.oscillation?.period_s ? `${number(diagnosis.oscillation.period_s)} s` : dash}<small>${diagnosis?.oscillation?.detected ? "oscillates" : ""}</small></dd></div>
    <div><dt>Since</dt><dd>${moment(row.since)}</dd></div>
    ${row.until && html`<div><dt>Shelved until</dt><dd>${moment(row.until)}</dd></div>`}
    ${row.by && html`<div><dt>Decided by</dt><dd>${row.by}</dd></div>`}
  </dl>`;
}

/** Samples that are held, and the new ones as they come. */
function Trend({ base, newest, roles }) {
  const [held, set] = useState(null);
  const loading = useRef(false);
  useEffect(() => {
    if (newest === undefined || newest === null || loading.current) return;
    loading.current = true;
    const last = held && held.time.length ? held.time.at(-1) : null;
    get(`${base}/window${last === null ? "" : `?since=${last}`}`).then((said) => set((now) => joined(last === null ? null : now, said)), () => {}).finally(() => { loading.current = false; });
  }, [newest, base]);
  const time = held?.time;
  const top = useMemo(() => held && [time, held.columns.pv, ...(roles.includes("sp") ? [held.columns.sp] : [])], [held]);
  const low = useMemo(() => held && [time, held.columns.op, ...(roles.includes("mv") ? [held.columns.mv] : [])], [held]);
  if (!held || time.length === 0) return html`<p class="quiet" role="status">No sample yet.</p>`;
  const span = duration(time.at(-1) - time[0]);
  return html`
    <${Chart} data=${top} height=${190} sync=${base} x=${{ time: true }} y=${{ label: "PV" }} text=${`PV over the last ${span}: ${said(held.columns.pv)}`}
      lines=${[{ label: "PV", colour: "measured" }, ...(roles.includes("sp") ? [{ label: "SP", colour: "setpoint", dash: [5, 4] }] : [])]} />
    <${Chart} data=${low} height=${160} sync=${base} x=${{ time: true }} y=${{ label: "OP" }} text=${`OP over the last ${span}: ${said(held.columns.op)}`}
      lines=${[{ label: "OP", colour: "measured" }, ...(roles.includes("mv") ? [{ label: "MV measured", colour: "valve" }] : [])]} />`;
}

const LONGEST = 7200; // samples drawn

function joined(now, { start, ts, columns }) {
  const n = columns.pv?.length ?? 0;
  const time = Array.from({ length: n }, (_, k) => start + k * ts);
  if (!now) return { time, columns };
  if (n === 0) return now;
  const all = { time: [...now.time, ...time].slice(-LONGEST), columns: {} };
  for (const role of Object.keys(columns)) all.columns[role] = [...(now.columns[role] ?? []), ...columns[role]].slice(-LONGEST);
  return all;
}

function said(values) {
  const finite = values.filter((value) => value !== null && value !== undefined);
  if (!finite.length) return "no values";
  return `from ${number(finite.reduce((a, b) => Math.min(a, b)))} to ${number(finite.reduce((a, b) => Math.max(a, b)))}, newest ${number(finite.at(-1))}`;
}

function Model({ model, diagnosis }) {
  const time = useMemo(() => model.pv.map((_, k) => model.start + k * model.ts), [model]);
  const top = useMemo(() => [time, model.pv, ...(model.sp ? [model.sp] : []), ...(model.model_pv ? [model.model_pv] : [])], [model]);
  const low = useMemo(() => [time, model.op, ...(model.valve ? [model.valve] : [])], [model]);
  const fit = diagnosis?.fit?.free_run_percent;
  return html`
    <${Chart} data=${top} height=${190} sync="model" x=${{ time: true }} y=${{ label: "PV" }} text=${`PV and PV of the model; the model explains ${number(fit)} percent`}
      lines=${[{ label: "PV", colour: "measured" }, ...(model.sp ? [{ label: "SP", colour: "setpoint", dash: [5, 4] }] : []), ...(model.model_pv ? [{ label: `PV of the model${fit ? `, fit ${number(fit)} %` : ""}`, colour: "model", width: 1.6 }] : [])]} />
    <${Chart} data=${low} height=${160} sync="model" x=${{ time: true }} y=${{ label: "OP" }} text="OP and the valve position of the model"
      lines=${[{ label: "OP", colour: "measured" }, ...(model.valve ? [{ label: "valve of the model", colour: "valve", width: 1.6 }] : [])]} />`;
}

function Reasons({ diagnosis }) {
  return html`<ul class="plainlist">${diagnosis.reasons.map((each) => html`<li>${each}</li>`)}</ul>`;
}

const SAYS = { stiction: ["sticks", "for"], no_stiction: ["healthy", "against"], undecided: ["undecided", "undecided"], not_applicable: ["not_testable", "not applicable"] };

function Methods({ base, methods }) {
  const [seen, look] = useState(null);
  const order = Object.keys(SAYS);
  const rows = Object.entries(methods).sort((a, b) => order.indexOf(a[1].verdict) - order.indexOf(b[1].verdict));
  if (!rows.length) return null;
  const count = (verdict) => rows.filter(([, each]) => each.verdict === verdict).length;
  return html`<details><summary>${rows.length} methods: ${count("stiction")} for stiction, ${count("no_stiction")} against, ${count("undecided")} undecided, ${count("not_applicable")} not applicable</summary>
    <div class="scroll" tabindex="0" role="group" aria-label="Table"><table class="methods"><caption class="unseen">Methods</caption>
      <thead><tr><th scope="col">Method</th><th scope="col">Says</th><th scope="col" class="number">Index</th><th scope="col" class="why">Why</th><th scope="col"><span class="unseen">Picture</span></th></tr></thead>
      <tbody>${rows.map(([name, each]) => html`<tr><th scope="row">${words(name)}</th><td class="says"><${Shape} group=${SAYS[each.verdict][0]} size=${13} /> ${SAYS[each.verdict][1]}</td>
        <td class="number">${number(each.index)}</td><td class="quiet why">${each.reason}</td><td>${each.verdict !== "not_applicable" && html`<button type="button" onClick=${() => look(name)}>Picture<span class="unseen"> of ${words(name)}</span></button>`}</td></tr>`)}</tbody></table></div>
    ${seen && html`<${Picture} address=${`${base}/methods/${seen}.svg`} name=${words(seen)} close=${() => look(null)} />`}</details>`;
}

function Picture({ address, name, close }) {
  const dialog = useRef(null);
  const [missing, set] = useState(false);
  useEffect(() => dialog.current.showModal(), []);
  return html`<dialog ref=${dialog} onClose=${close} aria-label=${`What ${name} saw`}><h2>${name}</h2>
    ${missing ? html`<p class="quiet">This method left no picture.</p>` : html`<img class="picture" src=${address} alt=${`What ${name} saw in this window`} onError=${() => set(true)} />`}
    <p><button type="button" onClick=${() => dialog.current.close()}>Close</button></p></dialog>`;
}

function Profile({ profile }) {
  const inside = profile.s.filter((_, k) => profile.error[k] <= profile.limit);
  const data = useMemo(() => [profile.s, profile.error, profile.s.map(() => profile.limit)], [profile]);
  const top = 1 + 4 * (profile.limit - 1);
  const width = inside.length ? Math.max(inside.at(-1) - inside[0], 0.02 * inside.at(-1)) : 0;
  const near = inside.length ? [Math.max(inside[0] - 2 * width, profile.s[0]), Math.min(inside.at(-1) + 2 * width, profile.s.at(-1))] : undefined;
  return html`<${Chart} data=${data} height=${170} x=${{ label: "S (OP units)", range: near }} y=${{ label: "error over the least", range: [1 - 0.3 * (profile.limit - 1), top] }}
    lines=${[{ label: "least error at this S", colour: "measured", width: 1.6 }, { label: "limit of the 90 % interval", colour: "model", dash: [5, 4] }]}
    text=${inside.length ? `Models that fit alike have S from ${number(inside[0])} to ${number(inside.at(-1))} OP units` : "No S within the interval"} />`;
}

function OnDemandMap({ base, start }) {
  const [state, set] = useState(null);
  const load = () => {
    set("waiting");
    get(`${base}/map`).then((map) => set({ map, start }), (error) => set({ fault: error.message }));
  };
  if (state === "waiting") return html`<p class="quiet" role="status">A worker tries every valve.</p>`;
  if (state?.fault) return html`<p class="problem" role="alert">${state.fault}</p>`;
  return html`${state?.map && html`<${ValveMap} map=${state.map} />`}
    ${(!state || state.start !== start) && html`<button type="button" onClick=${load}>${state ? "Compute for the newest window" : "Compute the map"}</button>`}`;
}

function History({ entries }) {
  const judged = useMemo(() => entries.filter((each) => each.kind === "diagnosis"), [entries]);
  const data = useMemo(() => {
    const value = (each, end) => (each.verdict === "no_stiction" ? null : each.stiction?.s?.[end] ?? null);
    return [judged.map((each) => each.time), judged.map((each) => value(each, "value")), judged.map((each) => value(each, "low")), judged.map((each) => value(each, "high"))];
  }, [judged]);
  const decided = entries.filter((each) => each.kind !== "diagnosis").slice(-30).reverse();
  if (!entries.length) return html`<p class="quiet">Nothing was kept yet.</p>`;
  return html`
    ${data[1].filter((each) => each !== null).length > 1 && html`<${Chart} data=${data} height=${150} x=${{ time: true }} y=${{ label: "S (OP units)" }} text=${`S over ${judged.length} windows: ${said(data[1])}`}
      lines=${[{ label: "S", colour: "measured", width: 1.8, points: 5 }, { label: "90 % interval, low", colour: "bar", dash: [3, 3] }, { label: "high", colour: "bar", dash: [3, 3] }]} />`}
    <p class="quiet">${judged.length} ${judged.length === 1 ? "window" : "windows"} judged${judged.length ? `, from ${moment(judged[0].time)} to ${moment(judged.at(-1).time)}` : ""}.</p>
    ${decided.length > 0 && html`<div class="scroll" tabindex="0" role="group" aria-label="Table"><table><caption class="unseen">Alarms and decisions</caption>
      <thead><tr><th scope="col">Time</th><th scope="col">What</th><th scope="col">Who</th><th scope="col">Comment</th></tr></thead>
      <tbody>${decided.map((each) => html`<tr><td class="nowrap">${moment(each.time)}</td><td>${words(each.action ?? each.state)}</td><td>${each.by ?? "diagnosis"}</td><td>${each.comment ?? ""}</td></tr>`)}</tbody></table></div>`}`;
}

function Settings({ about }) {
  const { settings, counters, row } = about;
  const rows = [["Bus", `${row.bus}, connection ${row.connection}`], ["Sampling time", `${number(settings.ts)} s`], ["Action", settings.acting ?? "not known"], ["Reads", settings.roles.map((each) => each.toUpperCase()).join(", ")],
    ["Range of OP", settings.op_range ? settings.op_range.map((each) => number(each)).join(" to ") : "not known"], ["Alarm comes, goes after", `${settings.on_delay}, ${settings.off_delay} windows`],
    ["Samples, bad", `${counters.samples}, ${counters.bad}`], ["Gaps in the window", counters.gaps]];
  return html`<table><caption class="unseen">Settings and counters</caption><tbody>${rows.map(([key, value]) => html`<tr><th scope="row" class="quiet">${key}</th><td>${value}</td></tr>`)}</tbody></table>`;
}
