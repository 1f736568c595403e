// Who wants to hear of changes.

/** A thing that others watch: changed() tells all of them, onChange(listener) returns a function that ends it. */
export class Observable {
  listeners = new Set();

  changed() {
    for (const listener of [...this.listeners]) listener();
  }

  onChange(listener) {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }
}
