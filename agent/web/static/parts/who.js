// The name with which a person signs, kept in this browser.
export const who = () => {
  try {
    return localStorage.getItem("slipjump.by") ?? "";
  } catch {
    return "";
  }
};

export const keepWho = (by) => {
  try {
    localStorage.setItem("slipjump.by", by);
  } catch { /* storage is off: the name is typed again */ }
};
