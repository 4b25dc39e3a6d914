// What mdBook leaves out for readers with a keyboard or a screen reader.

// What is wider than its place can be scrolled by the keyboard.
function scrollable() {
  for (const box of document.querySelectorAll(".table-wrapper, pre code, .equation")) {
    if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
    else box.removeAttribute("tabindex");
  }
}

// A head of a column that is a formula alone is read out as text.
for (const head of document.querySelectorAll("th")) {
  const formula = head.querySelector("math");
  const text = head.textContent.trim();
  if (formula && text === formula.textContent.trim()) {
    formula.setAttribute("aria-hidden", "true");
    const spoken = document.createElement("span");
    spoken.className = "spoken";
    spoken.textContent = text;
    head.append(spoken);
  }
}

document.getElementById("mdbook-menu-bar")?.setAttribute("role", "banner");
document.getElementById("mdbook-sidebar-toggle")?.setAttribute("role", "button");
addEventListener("load", scrollable);
addEventListener("resize", scrollable);
scrollable();
