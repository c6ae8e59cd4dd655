// Names of the program as words of the field: models, effects, parameters.
import { sentence } from "./format.js";

const NAMES = {
  fopdt: "first order with delay", sopdt: "second order with delay", two_tanks: "two tanks", deadband: "dead band",
  no_stiction: "no stiction", free_run: "free run",
};
const PARAMETERS = { s: "S", tau: "time constant", start: "at the start", j_over_s: "J / S", u_low: "low limit", u_high: "high limit", share: "share of S" };

const plain = (name) => NAMES[name] ?? name.replaceAll("_", " ").replace(/\b(op|pv|sp)\b/g, (role) => role.toUpperCase());

/** An effect, a model, an axis or a method. */
export const named = (name) => sentence(plain(name ?? ""));

/** ``deadband.s`` as [effect, parameter]; a parameter of the process has no effect. */
export function parameterWords(name) {
  const [first, second] = name.split(".");
  const own = second ?? first;
  return [second ? named(first) : "", PARAMETERS[own] ?? plain(own)];
}

/** A sentence of the program with its names as words. */
export const plainly = (text) => (text ?? "").replace(/[a-z]+(?:_[a-z0-9]+)+|\bfopdt\b|\bsopdt\b|\bdeadband\b/g, plain);
