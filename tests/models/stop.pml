/* What happens when a resource stops for good under virtual time (ringbus/cycle/tile/tile.cpp, ringbus/cycle/shading/resource_loss.h): R
 * resources on a ring of links, resource 0 may stop at any moment. Ray control places rays: each has an owner, who tests
 * it, and an issuer, whose packet carries it round. When control has heard the last sign of life it orders all to discard
 * their work, waits until each has its packet home, and then places the rays that have not come back at the others.
 * Rays come back once each, no packet is tested that was under way before, and all come to an end.
 *
 *   -DNO_DRAIN        control does not wait for anybody
 *   -DNOT_THE_STOPPED control does not wait for the packet of the one that stopped
 *   -DDEAD_PORT       the port of the one that stopped does not forward
 *   -DLATE_ORDERS     one that is to go on may hear of it after a packet of one that does already
 *   -DALL_AGAIN       rays that have come back are placed again */
#ifndef R
#define R 3
#endif
#ifndef RAYS
#define RAYS 2
#endif

#ifdef DEAD_PORT
#define PORT_WORKS !(r == 0 && stopped)
#else
#define PORT_WORKS true
#endif
/* Orders go to all at once and need no longer than a link, so who is to go on knows before a packet comes of one who does. */
#ifdef LATE_ORDERS
#define ORDERS_FIRST true
#else
#define ORDERS_FIRST !order[r]?[go_on, ray, owner]
#endif

mtype = { take, discard, go_on, done, last_beat, drained };

chan link[R] = [2] of { byte, byte, byte, byte, bit };   /* from r to the next: issuer, owner, ray, epoch, tested */
chan order[R] = [RAYS + 2] of { mtype, byte, byte };     /* control to r: ray, owner */
chan note[R] = [RAYS + 2] of { mtype, byte };            /* r to control: ray */
bool stopped;

proctype resource(byte r) {
  byte issuer, owner, ray, epoch, before, mine, its_owner, now_epoch;
  bit tested;
  bool out, drains, has;
  before = (r + R - 1) % R;
end:
  do
  /* stops */
  :: atomic { r == 0 && !stopped -> stopped = true; has = false; note[r]!last_beat(0) }
  /* hears */
  :: atomic { !has && order[r]?[take, ray, owner] -> order[r]?take(ray, owner);
       if
       :: (r == 0 && stopped) || drains -> skip
       :: else -> has = true; mine = ray; its_owner = owner
       fi }
  :: atomic { order[r]?[discard, ray, owner] -> order[r]?discard(ray, owner); has = false; drains = true }
  :: atomic { order[r]?[go_on, ray, owner] -> order[r]?go_on(ray, owner); drains = false; now_epoch++ }
  /* issues; what it owns it tests at once */
  :: atomic { has && !out && nfull(link[r]) ->
       has = false; out = true; link[r]!r, its_owner, mine, now_epoch, (its_owner == r) }
  /* a packet comes: home, through the testers, or past them */
  :: atomic { link[before]?[issuer, owner, ray, epoch, tested] && (link[before]?[eval(r), owner, ray, epoch, tested] || nfull(link[r])) && PORT_WORKS && ORDERS_FIRST -> link[before]?issuer, owner, ray, epoch, tested;
       if
       :: issuer == r ->
          out = false;
          if
          :: (r == 0 && stopped) || drains -> skip
          :: else ->
             assert(epoch == now_epoch);
             if
             :: tested -> note[r]!done(ray)
             :: else -> skip   /* its owner has stopped, and nobody knows yet */
             fi
          fi
       :: issuer != r && owner == r && !(r == 0 && stopped) && !drains ->
          assert(epoch == now_epoch);
          link[r]!issuer, owner, ray, epoch, 1
       :: else -> link[r]!issuer, owner, ray, epoch, tested
       fi }
  /* has its packet home */
  :: atomic { drains && !out -> note[r]!drained(0) };
     /* and only passes on until it is told */
end_drained:
       do
       :: atomic { order[r]?[go_on, ray, owner] -> order[r]?go_on(ray, owner); drains = false; now_epoch++; break }
       :: atomic { nempty(link[before]) && nfull(link[r]) && PORT_WORKS && ORDERS_FIRST -> link[before]?issuer, owner, ray, epoch, tested; link[r]!issuer, owner, ray, epoch, tested }
       od
  od
}

proctype control() {
  bool back[RAYS];
  byte left, r, ray, waits, lost;
  bool heard, gave_up;
  left = RAYS;
  lost = R;
  d_step { ray = 0; do :: ray < RAYS -> order[ray % R]!take(ray, (ray + 1) % R); ray++ :: else -> break od; ray = 0 }
  do
  :: left == 0 -> break
  :: atomic { left > 0 && heard && !gave_up -> gave_up = true; lost = 0; waits = 0;
       d_step { r = 0; do :: r < R -> order[r]!discard(0, 0); waits++; r++ :: else -> break od; r = 0 }
#ifdef NOT_THE_STOPPED
       waits--;
#endif
#ifdef NO_DRAIN
       waits = 0;
#endif
     }
  :: atomic { left > 0 && gave_up && lost == 0 && waits == 0 -> lost = R + 1;
       d_step {
         r = 0; do :: r < R -> order[r]!go_on(0, 0); r++ :: else -> break od;
         ray = 0;
         do
         :: ray < RAYS ->
            if
#ifndef ALL_AGAIN
            :: back[ray] -> skip
#endif
            :: else -> order[1 + ray % (R - 1)]!take(ray, 1 + (ray + 1) % (R - 1))
            fi;
            ray++
         :: else -> break
         od;
         r = 0; ray = 0 } }
  :: atomic { left > 0 && note[0]?[last_beat, ray] -> note[0]?last_beat(ray); heard = true }
  :: atomic { left > 0 && note[0]?[drained, ray] -> note[0]?drained(ray);
#ifndef NOT_THE_STOPPED
       if :: waits > 0 -> waits-- :: else -> skip fi
#endif
     }
  :: atomic { left > 0 && note[1]?[drained, ray] -> note[1]?drained(ray); if :: waits > 0 -> waits-- :: else -> skip fi }
  :: atomic { left > 0 && note[2]?[drained, ray] -> note[2]?drained(ray); if :: waits > 0 -> waits-- :: else -> skip fi }
  :: atomic { left > 0 && note[0]?[done, ray] -> note[0]?done(ray); assert(!back[ray]); back[ray] = true; left-- }
  :: atomic { left > 0 && note[1]?[done, ray] -> note[1]?done(ray); assert(!back[ray]); back[ray] = true; left-- }
  :: atomic { left > 0 && note[2]?[done, ray] -> note[2]?done(ray); assert(!back[ray]); back[ray] = true; left-- }
  od
}

init {
  byte k;
  atomic { k = 0; do :: k < R -> run resource(k); k++ :: else -> break od; run control() }
}
