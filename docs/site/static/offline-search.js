// Of a site that is opened from a disk no page may fetch another one, which the search does for its
// excerpts. Scripts it may load: the text of each page stands in one (docs/site/excerpts.py).
if (location.protocol === "file:") {
  const waiting = new Map();
  window.pageText = (name, text) => waiting.get(name)?.(text);
  window.fetch = (url) => new Promise((done, failed) => {
    const root = document.documentElement.dataset.content_root;
    const name = url.slice(root.length).replace(/\.html$/, "");
    waiting.set(name, (text) => {
      const page = document.createElement("div");
      page.setAttribute("role", "main");
      page.textContent = text;
      done({ text: () => Promise.resolve(page.outerHTML) });
    });
    const script = document.createElement("script");
    script.src = `${root}_static/text/${name}.js`;
    script.onerror = failed;
    document.head.append(script);
  });
}
