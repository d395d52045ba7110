/* The rules that keep a ring of bounded links moving (ringbus/deadlock.h, ringbus/native_port.h): R resources, a link of
 * DEPTH places from each to the next, a hand at each for what it has taken in and not yet sent on. A packet goes round
 * and is taken off by its owner. Ring traffic is *not* served first here: the schedule may inject whenever the rule
 * allows.
 *
 *   -DRULE=1  credits: at most DEPTH packets of a resource are out
 *   -DRULE=2  bubble: a packet enters only where two places of the link are free
 *   -DRULE=0  neither: must deadlock (the planted fault)
 *   -DPLACES=n  the hand of the cycle engine (ringbus/cycle/ports.h): n places, and it takes a packet in whenever one is
 *   free. A resource knows of places in the link by credits, which come back late; a packet of its own takes a place in
 *   hand, and with the bubble rule only if two places of the link are left that nothing in hand will take.
 *   Why that is enough. Let a resource's *spare* be its credits minus the packets in its hand: -h if the next link is full
 *   and the hand holds h. Forwarding keeps the sum of all spares, and a retirement raises it by one. Nothing moves only if
 *   all links and all hands of h places are full: a sum of -R h. But a packet is injected only at a spare of 2 or more, and
 *   the others are at least -h, so that the sum is then at least 1 - (R - 1) h.
 *   -DGREEDY_HAND with bubble: takes in as much as a link holds, whatever the link onward has room for. Each hand then
 *   takes places that the bubble has been counted on for, and three resources can fill the ring in spite of it. */
#ifndef R
#define R 3
#endif
#ifndef DEPTH
#define DEPTH 2
#endif
#ifndef RULE
#define RULE 1
#endif
#ifndef MOST
#define MOST (DEPTH + 2)   /* packets a resource has at all */
#endif
#if RULE == 2 && !defined(GREEDY_HAND)
/* No more than the link onward takes at once, which only this resource fills: nothing stays in hand but the last. */
#define TAKES (len(link[r]) < DEPTH -> DEPTH - len(link[r]) : 1)
#else
#define TAKES DEPTH
#endif

#if RULE == 1
#define MAY_ENTER out[r] < DEPTH
#elif RULE == 2 && defined(PLACES)
#define MAY_ENTER credit[r] >= len(hand) + 2
#elif RULE == 2
#define MAY_ENTER len(link[r]) + 2 <= DEPTH
#else
#define MAY_ENTER true
#endif

chan link[R] = [DEPTH] of { byte };   /* from resource r to the next; what travels is the owner */
byte out[R];                          /* packets of r that are under way */

#ifdef PLACES
byte credit[R], back[R];   /* places of link[r] that r knows to be free; those it has not heard of yet */

proctype resource(byte r) {
  chan hand = [PLACES] of { byte };
  byte owner, before;
  before = (r + R - 1) % R;
  credit[r] = DEPTH;
  do
  :: atomic { nempty(hand) && credit[r] > 0 -> credit[r]--; hand?owner; link[r]!owner }
  :: atomic { back[r] > 0 -> back[r]--; credit[r]++ }
  :: atomic { link[before]?[eval(r)] -> link[before]?owner; back[before]++; out[r]-- }
  :: atomic { nempty(link[before]) && !link[before]?[eval(r)] && nfull(hand) -> link[before]?owner; back[before]++; hand!owner }
  :: atomic { nfull(hand) && out[r] < MOST && MAY_ENTER -> out[r]++; hand!r }
  od
}
#else
proctype resource(byte r) {
  chan hand = [DEPTH] of { byte };
  byte owner, before, k, most;
  before = (r + R - 1) % R;
  do
  /* sends on what is in hand */
  :: atomic { nempty(hand) && nfull(link[r]) -> hand?owner; link[r]!owner }
  /* takes in, only with empty hands: a batch of any length up to what the hand may hold */
  :: empty(hand) && nempty(link[before]) ->
     k = 0;
     most = TAKES;
     do
     :: k < most && nempty(link[before]) ->
        atomic {
          link[before]?owner;
          if
          :: owner == r -> out[r]--
          :: else -> hand!owner
          fi;
          k++
        }
     :: k > 0 -> break
     od
  /* sends a packet of its own; nothing in hand waits behind it */
  :: atomic { empty(hand) && nfull(link[r]) && out[r] < MOST && MAY_ENTER -> out[r]++; link[r]!r }
  od
}

#endif

init {
  byte k;
  atomic { k = 0; do :: k < R -> run resource(k); k++ :: else -> break od }
}
/* Nobody can move: Spin's invalid end state is the deadlock. */
