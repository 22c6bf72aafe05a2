// The root tile is asked for before the code that draws it is there.

type Fetch = (url: string, init?: RequestInit) => Promise<Response>;

const ROOT = 'tiles/00/000000.glb';

/// Asks for the root of the hierarchy at `url` at once. What it returns gives that answer to the first who asks
/// for it, and fetches all else as usual.
export function fetchRootEarly(url: string): Fetch {
  const root = `${url}/${ROOT}`;
  let early: Promise<Response> | null = fetch(root, { priority: 'high' });
  early.catch(() => undefined); // whoever asks for it is told
  return (asked, init) => {
    const answer = asked === root ? early : null;
    if (answer === null) return fetch(asked, init);
    early = null;
    return answer;
  };
}
