// The theme that was chosen, before anything is drawn; without a choice the system's applies.
try {
  const chosen = localStorage.getItem("slipjump.theme");
  if (chosen === "light" || chosen === "dark") document.documentElement.dataset.theme = chosen;
} catch { /* storage is off: the system's theme applies */ }
