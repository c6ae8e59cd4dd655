// A shape and a word for each group and alarm state: nothing is said by colour alone.
import { html } from "./html.js";

const SHAPES = {
  sticks: html`<path d="M8 1.2 15 14.3H1z" class="fill" />`,
  suspected: html`<path d="M8 2 14.2 13.6H1.8z" class="stroke" />`,
  tight_tuning: html`<path d="M1 8h2l2-6 3 12 3-9 1.6 3H15" class="stroke" />`,
  disturbance: html`<path d="M1 8c2-7 4-7 7 0s5 7 7 0" class="stroke" />`,
  undecided: html`<path d="M8 1.8 14.2 8 8 14.2 1.8 8z" class="stroke" /><path d="M8 6.6v2.8" class="stroke" />`,
  not_testable: html`<circle cx="8" cy="8" r="6.2" class="stroke" /><path d="M3.8 12.2 12.2 3.8" class="stroke" />`,
  healthy: html`<path d="M3.2 8.4 6.6 11.6 12.8 4.8" class="stroke" />`,
  waiting: html`<circle cx="3" cy="8" r="1.3" class="fill" /><circle cx="8" cy="8" r="1.3" class="fill" /><circle cx="13" cy="8" r="1.3" class="fill" />`,
  stale: html`<circle cx="8" cy="8" r="6.2" class="stroke dashed" /><path d="M8 4.4V8l2.4 1.8" class="stroke" />`,
};

export const GROUPS = {
  sticks: "Sticks", suspected: "Suspected", tight_tuning: "Tight tuning", disturbance: "Disturbance", undecided: "Undecided",
  not_testable: "Not testable", healthy: "No stiction", waiting: "No verdict yet", stale: "Stale data",
};

export function Shape({ group, size = 16 }) {
  return html`<svg class=${`shape ${group}`} viewBox="0 0 16 16" width=${size} height=${size} aria-hidden="true">${SHAPES[group]}</svg>`;
}

const ALARMS = {
  unacked_active: ["Alarm, not acknowledged", "alarm"],
  acked_active: ["Alarm, acknowledged", "acked"],
  returned_unacked: ["Gone, not acknowledged", "returned"],
  shelved: ["Shelved", "silent"],
  out_of_service: ["Out of service", "silent"],
  normal: ["", ""],
};

export const alarmWords = (state) => ALARMS[state]?.[0] || "Normal";
const BRIEF = { unacked_active: "Unacknowledged", acked_active: "Acknowledged", returned_unacked: "Returned" };

/** The state of an alarm; ``brief`` in a column that is called so already. */
export function AlarmMark({ row, brief = false }) {
  const [text, kind] = ALARMS[row.alarm] ?? ["", ""];
  if (!text) return html`<span class="quiet">Normal</span>`;
  const sign = { alarm: "●", acked: "◉", returned: "○", silent: "◌" }[kind];
  return html`<span class=${`alarm-mark ${kind}`}><span aria-hidden="true">${sign}</span>\u00a0${brief ? BRIEF[row.alarm] ?? text : text}${row.alarm === "unacked_active" && row.priority ? html` <span class="priority">${row.priority}</span>` : ""}</span>`;
}
