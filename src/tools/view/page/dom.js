// Helpers for the document, used by all parts of the page.

/** Creates an element with attributes and children; text is never parsed as markup. */
function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/** Returns a function that runs `work` in the next frame, once for any number of calls. */
function oncePerFrame(work) {
  let request = 0;
  return () => {
    request ||= requestAnimationFrame(() => {
      request = 0;
      work();
    });
  };
}
