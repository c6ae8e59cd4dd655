// What a person decides of a loop: the alarm, a judgement of one's own, a repair. All is signed.
import { send } from "./api.js";
import { html, useState } from "./html.js";
import { keepWho, who } from "./who.js";

export function Decision({ row, id, decided }) {
  const [by, setBy] = useState(who());
  const [comment, setComment] = useState("");
  const [hours, setHours] = useState("8");
  const [said, say] = useState(null);
  const [busy, setBusy] = useState(false);
  /** Sends a decision; where it needs a reason, the comment must have one. */
  const act = async (path, body, { reason = "", done }) => {
    const missing = by.trim() ? (reason && !comment.trim() ? "decision-comment" : "") : "decision-by";
    if (missing) {
      say({ fault: true, text: missing === "decision-by" ? "Enter your name first: decisions are signed." : `Enter ${reason} as the comment first.` });
      document.getElementById(missing).focus();
      return;
    }
    setBusy(true);
    try {
      keepWho(by.trim());
      await send(`/api/loops/${encodeURIComponent(row.loop)}/${path}`, { by: by.trim(), comment, ...body });
      say({ fault: false, text: done });
      setComment("");
      decided?.();
    } catch (error) {
      say({ fault: true, text: error.message });
    } finally {
      setBusy(false);
    }
  };
  const order = (action, more = {}, reason = "") => act("orders", { action, alarm: id ?? null, ...more }, { reason, done: "Done. The buses get the new state." });
  const judge = (judgement) => act("judgement", { judgement }, { reason: "why you judge so", done: "Kept. The work list shows it; the alarm stays as it is." });
  const unacknowledged = row.alarm === "unacked_active" || row.alarm === "returned_unacked";
  const silenced = row.alarm === "shelved" || row.alarm === "out_of_service";
  return html`<div class="decision">
    <label class="field">Your name<input id="decision-by" value=${by} maxlength="80" autocomplete="name" onInput=${(event) => setBy(event.target.value)} /></label>
    <label class="field">Comment or reason<textarea id="decision-comment" rows="2" maxlength="1000" value=${comment} onInput=${(event) => setComment(event.target.value)}></textarea></label>
    <fieldset class="group"><legend>Alarm</legend>
      <div class="buttons">
        <button type="button" class=${unacknowledged ? "primary" : ""} data-testid="acknowledge" disabled=${busy || !unacknowledged} onClick=${() => order("acknowledge")}>Acknowledge</button>
        ${row.alarm === "out_of_service"
          ? html`<button type="button" disabled=${busy} onClick=${() => order("in_service")}>Return to service</button>`
          : html`<button type="button" disabled=${busy} onClick=${() => order("out_of_service", {}, "a reason")}>Out of service</button>`}
        ${row.alarm === "shelved" && html`<button type="button" data-testid="unshelve" disabled=${busy} onClick=${() => order("unshelve")}>Unshelve</button>`}
      </div>
      ${row.alarm !== "out_of_service" && html`<div class="buttons"><button type="button" data-testid="shelve" disabled=${busy || !(Number(hours) > 0)} onClick=${() => order("shelve", { hours: Number(hours) }, "a reason")}>${silenced ? "Shelve anew" : "Shelve"}</button>
        <label class="beside">for <input type="number" min="0.1" max="8760" step="any" value=${hours} onInput=${(event) => setHours(event.target.value)} aria-label="Hours" /> hours</label></div>`}
    </fieldset>
    <fieldset class="group"><legend>Your own judgement</legend>
      <div class="buttons"><button type="button" disabled=${busy} data-testid="judge-sticks" onClick=${() => judge("sticks")}>It sticks</button>
        <button type="button" disabled=${busy} data-testid="judge-sound" onClick=${() => judge("sound")}>It is sound</button>
        ${row.judgement && html`<button type="button" disabled=${busy} onClick=${() => judge("withdrawn")}>Withdraw</button>`}</div></fieldset>
    <fieldset class="group"><legend>Maintenance</legend>
      <div class="buttons"><button type="button" disabled=${busy} data-testid="repaired" onClick=${() => act("repair", {}, { reason: "what was done", done: "Kept. The history of S shows it." })}>It was repaired</button></div></fieldset>
    <p role="status" class=${said?.fault ? "problem" : "done"} hidden=${!said}>${said?.text}</p>
  </div>`;
}
