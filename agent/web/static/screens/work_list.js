// The work list: loops ranked by what to do next. Ranked, filtered and paged by the server; rows change by themselves.
import { StickBand, Sparkline } from "../parts/bars.js";
import { duration, moment, percent, sentence, when } from "../parts/format.js";
import { html, useEffect, useState } from "../parts/html.js";
import { AlarmMark, GROUPS, Shape } from "../parts/marks.js";
import { navigate } from "../parts/router.js";
import { useStream } from "../parts/stream.js";
import { PlantGroups } from "../parts/plant_groups.js";
import { PlantMap } from "../parts/plant_map.js";

const FILTERS = ["sticks", "suspected", "tight_tuning", "disturbance", "undecided", "not_testable", "healthy", "waiting", "stale"];
const NAMED = ["sticks", "suspected", "tight_tuning", "disturbance", "not_testable", "stale"]; // filters that are always there
const SORTS = { next: "What to do next", name: "Name", s: "Widest S", probability: "Probability", since: "Newest" };
const SIZE = 50;

export default function WorkList({ address }) {
  const query = new URL(address, location.origin).searchParams;
  const view = query.get("view") ?? "list";
  const wanted = new URLSearchParams({ size: SIZE });
  for (const name of ["group", "search", "area", "sort", "page"]) if (query.get(name)) wanted.set(name, query.get(name));
  const parts = useStream(`/api/work-list/stream?${wanted}`);
  useEffect(() => { document.title = "Work list"; }, []);
  const go = (changes) => {
    const next = new URLSearchParams(query);
    if (!("page" in changes)) next.delete("page");
    for (const [name, value] of Object.entries(changes)) {
      if (value) next.set(name, value);
      else next.delete(name);
    }
    navigate(`/?${next}`.replace(/\?$/, ""), true);
  };
  const counts = parts?.counts;
  const loops = parts?.plant.loops ?? 0;
  return html`
    <div class="headline">
      <h1>Work list</h1>
      <p class="lead">${counts ? summary(counts, loops) : "Looking at the plant"}</p>
      <div class="views" role="group" aria-label="View">
        <button type="button" aria-pressed=${view === "list"} onClick=${() => go({ view: "" })}>List</button>
        <button type="button" aria-pressed=${view === "map"} onClick=${() => go({ view: "map" })}>Map</button>
      </div>
    </div>
    <div class="filters" role="group" aria-label="Filter by verdict">
      <button type="button" class="filter" aria-pressed=${!query.get("group")} onClick=${() => go({ group: "" })}>All <span class="count">${loops}</span></button>
      ${FILTERS.filter((group) => counts && (counts[group] > 0 || NAMED.includes(group) || query.get("group") === group)).map((group) => html`
        <button type="button" class=${`filter ${group} ${counts[group] ? "" : "nobody"}`} key=${group} aria-pressed=${query.get("group") === group}
          onClick=${() => go({ group: query.get("group") === group ? "" : group })}>
          <${Shape} group=${group} size=${13} /> ${GROUPS[group]} <span class="count">${counts[group]}</span></button>`)}
    </div>
    <div class="tools">
      <${Search} text=${query.get("search") ?? ""} search=${(text) => go({ search: text })} />
      ${query.get("area") && html`<button type="button" class="chip" onClick=${() => go({ area: "" })}>Area ${query.get("area")} <span aria-hidden="true">×</span><span class="unseen">, remove</span></button>`}
      ${view === "list" && html`<label class="inline">Order <select value=${query.get("sort") ?? "next"} onChange=${(event) => go({ sort: event.target.value === "next" ? "" : event.target.value })}>
        ${Object.entries(SORTS).map(([value, text]) => html`<option value=${value} selected=${value === (query.get("sort") ?? "next")}>${text}</option>`)}</select></label>`}
    </div>
    <${PlantGroups} />
    ${view === "map" ? html`<${PlantMap} choose=${(area) => go({ area, view: "" })} shown=${fits(query)} />` : html`<${List} parts=${parts} />`}
    ${view === "list" && parts && html`<${Pages} plant=${parts.plant} page=${Number(query.get("page") ?? 0)} go=${go} />`}`;
}

/** Which loops of the map the filter and the search mean; the others are dimmed. */
function fits(query) {
  const [wanted, search] = [query.get("group"), (query.get("search") ?? "").toLowerCase()];
  if (!wanted && !search) return null;
  return (name, group, stale) => (!wanted || (wanted === "stale" ? stale : group === wanted)) && name.toLowerCase().includes(search);
}

function summary(counts, loops) {
  if (loops === 0) return "The configuration has no loops.";
  const said = [];
  if (counts.sticks) said.push(`${counts.sticks} of ${loops} valves stick`);
  else said.push(`No valve of ${loops} is known to stick`);
  if (counts.suspected) said.push(`${counts.suspected} suspected`);
  if (counts.stale) said.push(`${counts.stale} without fresh data`);
  return `${said.join(", ")}.`;
}

function Search({ text, search }) {
  const [typed, set] = useState(text);
  useEffect(() => {
    if (typed === text) return undefined;
    const timer = setTimeout(() => search(typed), 250);
    return () => clearTimeout(timer);
  }, [typed]);
  return html`<label class="search"><span class="unseen">Search loops</span>
    <input type="search" placeholder="Search loops" value=${typed} onInput=${(event) => set(event.target.value)} /></label>`;
}

function List({ parts }) {
  const order = parts?.order ?? [];
  return html`<div class="card list-card" tabindex="0" role="group" aria-label="Work list">
    <table class="work-list" data-testid="work-list" aria-busy=${!parts}>
      <caption class="unseen">Loops, what needs somebody first</caption>
      <thead><tr>
        <th scope="col">Loop</th><th scope="col">Verdict</th><th scope="col">S, OP units, 90 % interval</th>
        <th scope="col" class="number">Probability</th><th scope="col"><span class="ink-op">OP</span> and <span class="ink-pv">PV</span></th><th scope="col">Alarm</th><th scope="col">Since</th><th scope="col" class="number">Data age</th>
      </tr></thead>
      <tbody>${order.map((name) => html`<${Row} key=${name} row=${parts[`row:${name}`]} spark=${parts[`spark:${name}`]} age=${parts.ages[name]} widest=${parts.plant.widest} />`)}</tbody>
    </table>
    ${!parts && html`<p class="empty" role="status">Looking at the plant</p>`}
    ${parts && order.length === 0 && html`<div class="empty"><p><strong>${parts.plant.loops ? "No loop fits." : "No loop yet."}</strong></p>
      <p>${parts.plant.loops ? "Choose another filter, or clear the search." : "Add loops to the configuration file, or under Configure."}</p></div>`}
  </div>`;
}

function Row({ row, spark, age, widest }) {
  const stale = row.data === "stale";
  return html`<tr data-loop=${row.loop} data-verdict=${row.verdict} class=${`${row.group} ${row.alarm}`}>
    <th scope="row" class="loop"><a href=${`/loops/${encodeURIComponent(row.loop)}`}>${row.loop}</a><span class="under">${row.connection}</span></th>
    <td class="verdict"><span class=${`verdict-words ${row.group}`}><${Shape} group=${row.group} /> ${row.words}</span>${row.judgement && html`<span class="under">judged by ${row.judgement.by}</span>`}
      ${row.next && html`<span class="under next" title=${sentence(row.next)}>${sentence(row.next.split(/[:;]/)[0])}</span>`}</td>
    <td class="band-cell" data-label="S, OP units"><${StickBand} s=${row.s} widest=${widest} doubt=${row.doubt} /></td>
    <td class="number" data-label="Probability">${percent(row.probability)}</td>
    <td class="spark-cell"><${Sparkline} spark=${spark} loop=${row.loop} /></td>
    <td data-label="Alarm" class="alarm-cell"><${AlarmMark} row=${row} brief=${true} /></td>
    <td data-label="Since" class="nowrap" title=${moment(row.since)}>${when(row.since)}</td>
    <td class=${`number age ${stale ? "stale" : ""}`} data-label="Data age">${stale && html`<${Shape} group="stale" size=${13} /> `}${age === null ? "never" : duration(age)}${stale ? html`<span class="unseen"> stale</span>` : ""}</td>
  </tr>`;
}

function Pages({ plant, page, go }) {
  const last = Math.max(Math.ceil(plant.fitting / SIZE) - 1, 0);
  if (last === 0) return null;
  return html`<nav class="pages" aria-label="Pages of the list">
    <button type="button" disabled=${page === 0} onClick=${() => go({ page: page - 1 || "" })}>Previous</button>
    <span>${page * SIZE + 1} to ${Math.min((page + 1) * SIZE, plant.fitting)} of ${plant.fitting}</span>
    <button type="button" disabled=${page >= last} onClick=${() => go({ page: page + 1 })}>Next</button></nav>`;
}
