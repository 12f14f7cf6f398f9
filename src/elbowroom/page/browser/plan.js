"use strict";
// the planning panel is viser's: what it leaves without a name gets one, and what is too pale gets darker
(() => {
  const frame = document.querySelector("iframe"), words = frame.dataset, AGAIN_MS = 150;

  function labelOf(node) {
    for (let at = node.parentElement; at; at = at.parentElement) {
      const label = at.querySelector("label");
      if (label) return label.textContent.trim();
    }
    return "";
  }

  function name(page) {
    for (const one of page.querySelectorAll("input:not([type=hidden]), textarea, [role=slider]")) {
      if (!one.labels?.length && !one.getAttribute("aria-label")) one.setAttribute("aria-label", labelOf(one));
    }
    for (const one of page.querySelectorAll("button")) {
      if (one.textContent.trim() || one.getAttribute("aria-label")) continue;
      one.setAttribute("aria-label", one.className.includes("closeButton") ? words.close : words.settings);
    }
  }

  function mend() {
    const page = frame.contentDocument;
    page.documentElement.lang = document.documentElement.lang;
    const style = page.createElement("link");
    Object.assign(style, {rel: "stylesheet", href: "/plan.css"});
    page.head.append(style);
    let timer = null;
    const again = () => { timer ??= setTimeout(() => { timer = null; name(page); }, AGAIN_MS); };
    new MutationObserver(again).observe(page.body, {childList: true, subtree: true});
    name(page);
  }

  if (frame.contentDocument?.readyState === "complete" && frame.contentDocument.URL !== "about:blank") mend();
  else frame.addEventListener("load", mend);
})();
