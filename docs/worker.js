// The site's search runs in a worker, which browsers refuse to a page opened from a folder: there an unseen frame does its work.
if (location.protocol === "file:") {
  window.IFrameWorker = window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      this.frame.title = "search";
      document.body.append(this.frame);
      this.waiting = [];
      const here = new URL(url, document.baseURI);
      const scope = this.frame.contentWindow;
      const load = (source) => new Promise((done, failed) => {
        const script = scope.document.createElement("script");
        script.src = new URL(source, here).href;
        script.onload = done;
        script.onerror = failed;
        scope.document.body.append(script);
      });
      scope.importScripts = (...sources) => sources.reduce((before, source) => before.then(() => load(source)), Promise.resolve());
      scope.postMessage = (data) => {
        const event = new MessageEvent("message", { data });
        this.dispatchEvent(event);
        if (this.onmessage) this.onmessage(event);
      };
      load(here.href).then(() => {
        const waiting = this.waiting;
        this.waiting = null;
        for (const data of waiting) this.postMessage(data);
      });
    }

    postMessage(data) {
      if (this.waiting) this.waiting.push(data);
      else this.frame.contentWindow.dispatchEvent(new MessageEvent("message", { data }));
    }

    terminate() { this.frame.remove(); }
  };
}
