// The list of alarms after ISA-18.2: not acknowledged first, then active, shelved with time left, out of service.
import { get, send } from "../parts/api.js";
import { duration, moment, number, sentence, when, words } from "../parts/format.js";
import { html, useEffect, useState } from "../parts/html.js";
import { AlarmMark, Shape, alarmWords } from "../parts/marks.js";
import { navigate } from "../parts/router.js";
import { useStream } from "../parts/stream.js";
import { who } from "../parts/who.js";

const SECTIONS = ["unacked_active", "returned_unacked", "acked_active", "shelved", "out_of_service"];
const OPEN = new Set(["unacked_active", "returned_unacked"]);
const pageOf = (loop) => `/loops/${encodeURIComponent(loop)}`;

export default function Alarms() {
  const parts = useStream("/api/alarms/stream");
  const [decisions, set] = useState([]);
  const [fault, setFault] = useState(null);
  const alarms = parts?.alarms;
  useEffect(() => { document.title = "Alarms"; }, []);
  useEffect(() => {
    const stop = new AbortController();
    get("/api/alarms/decisions", stop.signal).then(set, () => {});
    return () => stop.abort();
  }, [JSON.stringify(alarms?.map((each) => [each.loop, each.alarm, each.until]))]);
  const acknowledge = async (row) => {
    setFault(null);
    if (!who()) return navigate(pageOf(row.loop)); // decisions are signed: the name is entered there once
    try {
      await send(`/api${pageOf(row.loop)}/orders`, { action: "acknowledge", by: who(), alarm: row.id });
    } catch (error) {
      setFault(error.message);
    }
    return undefined;
  };
  const open = alarms?.filter((each) => OPEN.has(each.alarm)).length;
  const reason = (loop, action) => decisions.find((each) => each.loop === loop && each.action === action)?.comment ?? "";
  const sections = SECTIONS.map((state) => [state, (alarms ?? []).filter((each) => each.alarm === state)]).filter(([, rows]) => rows.length);
  return html`<div class="headline"><h1>Alarms</h1>
      <p class="lead">${alarms ? (alarms.length ? `${open} to acknowledge, ${alarms.length - open} known.` : "") : "Looking at the plant"}</p></div>
    ${fault && html`<p class="problem" role="alert">${fault}</p>`}
    ${alarms && alarms.length === 0 && html`<section class="card empty"><p><strong>All alarms are normal.</strong></p><p>A valve that begins to stick appears here.</p></section>`}
    <div class="stack">${sections.map(([state, rows]) => html`
      <section class="card" key=${state}><h2>${alarmWords(state)} <span class="count">${rows.length}</span></h2>
        <div class="scroll" tabindex="0" role="group" aria-label=${`Table: ${alarmWords(state)}`}><table class="alarm-list cards"><caption class="unseen">${alarmWords(state)}</caption>
          <thead><tr><th scope="col">Loop</th><th scope="col">Verdict</th><th scope="col" class="number">S, OP units</th><th scope="col">Priority</th><th scope="col">NE 107</th><th scope="col">Since</th><th scope="col">${state === "shelved" ? "Time left" : OPEN.has(state) ? html`<span class="unseen">Acknowledge</span>` : "By"}</th></tr></thead>
          <tbody>${rows.map((row) => html`<tr key=${row.loop} data-loop=${row.loop} data-alarm=${row.alarm}><th scope="row"><a href=${pageOf(row.loop)}>${row.loop}</a></th>
            <td><span class=${`verdict-words ${row.group}`}><${Shape} group=${row.group} size=${14} /> ${row.words}</span></td>
            <td class="number" data-label="S, OP units">${number(row.s?.value)}</td><td data-label="Priority">${sentence(row.priority)}</td><td data-label="NE 107">${sentence(words(row.ne107))}</td><td class="nowrap" data-label="Since" title=${moment(row.since)}>${when(row.since)}</td>
            <td class="wide-cell">${OPEN.has(state) ? html`<button type="button" class="small" data-testid="acknowledge-here" onClick=${() => acknowledge(row)}>Acknowledge<span class="unseen"> ${row.loop}</span></button>`
              : html`${state === "shelved" ? `${duration(row.until - Date.now() / 1000)}, by ${row.by}` : row.by ?? ""}<span class="under">${reason(row.loop, { shelved: "shelve", out_of_service: "out_of_service", acked_active: "acknowledge" }[state])}</span>`}</td></tr>`)}</tbody></table></div></section>`)}
    <section class="card"><h2>Who did what</h2>
      ${decisions.length === 0 ? html`<p class="quiet">Nobody decided anything yet, and no alarm came.</p>` : html`<div class="scroll" tabindex="0" role="group" aria-label="Table: who did what"><table class="cards"><caption class="unseen">Changes of alarms and decisions, the newest first</caption>
        <thead><tr><th scope="col">Time</th><th scope="col">Loop</th><th scope="col">What</th><th scope="col">Who</th><th scope="col">Comment</th></tr></thead>
        <tbody>${decisions.map((each) => html`<tr><td class="nowrap">${moment(each.time)}</td><td><a href=${pageOf(each.loop)}>${each.loop}</a></td>
          <td class="nowrap">${each.kind === "note" ? sentence(words(each.action)) : html`<${AlarmMark} row=${{ alarm: each.state, priority: "" }} />`}</td><td data-label="Who">${each.by ?? "diagnosis"}</td><td class="said wide-cell">${each.comment ?? ""}</td></tr>`)}</tbody></table></div>`}
    </section></div>`;
}
