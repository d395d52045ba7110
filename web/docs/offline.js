// The search of a site that is opened from a disk (file:). Browsers start no Worker there and fetch no file, but run
// scripts. So the worker's script runs in a frame that is not shown, and the index comes as a script.
if (location.protocol === 'file:') {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      this.waiting = [];
      const frame = document.createElement('iframe');
      frame.hidden = true;
      frame.title = 'search';
      const start = () => {
        const page = frame.contentDocument;
        frame.contentWindow.postMessage = (data) => this.answer(data);
        const script = page.createElement('script');
        script.src = url;
        script.onload = () => {
          this.inside = frame.contentWindow;
          for (const data of this.waiting) this.postMessage(data);
        };
        page.head.append(script);
      };
      const add = () => { document.body.append(frame); start(); };
      if (document.body) add(); else addEventListener('DOMContentLoaded', add);
    }
    answer(data) {
      const event = new MessageEvent('message', {data});
      this.dispatchEvent(event);
      if (this.onmessage) this.onmessage(event);
    }
    postMessage(data) {
      if (this.inside) this.inside.dispatchEvent(new MessageEvent('message', {data}));
      else this.waiting.push(data);
    }
  };
}
