/* The single-producer single-consumer ring of ringbus/queues/spsc_ring.h.
 *
 * Spin's processes see every write at once, in program order: sequential consistency. A release that pairs with an
 * acquire gives the same guarantee for what stands before and after it, which is all the ring uses; what a missing
 * release would allow (the index seen before the cell) is the fault PUBLISH_FIRST. Indices count on and are compared
 * by difference; here modulo 2 * CELLS * 8, as they are modulo 2^64 there.
 *
 * Faults to plant: -DPUBLISH_FIRST the index before the cell; -DFREE_FIRST the cell given back before it is read;
 * -DONE_TOO_MANY takes capacity + 1; -DSTALE_COPY the cached index is taken for a fresh one that is ahead. */
#ifndef CAPACITY
#define CAPACITY 2
#endif
#ifndef CELLS
#define CELLS 2      /* a power of two >= CAPACITY */
#endif
#ifndef MESSAGES
#define MESSAGES 5
#endif
#ifndef BATCH
#define BATCH 2
#endif

#ifdef ONE_TOO_MANY
#define ROOM (CAPACITY + 1)
#else
#define ROOM CAPACITY
#endif

byte cells[CELLS];
byte tail, head;           /* the two shared indices */
byte received;             /* what the consumer has checked */

proctype producer() {
  byte sent, other, count, i, want;
  do
  :: sent < MESSAGES ->
     if :: want = 1 :: want = BATCH fi;
     if :: want > MESSAGES - sent -> want = MESSAGES - sent :: else fi;
     /* the cached index, refreshed when it does not promise enough room */
     if
     :: ROOM - (sent - other) < want -> other = head
     :: else
     fi;
#ifdef STALE_COPY
     other = tail;
#endif
     count = ROOM - (sent - other);
     if :: count > want -> count = want :: else fi;
#ifdef PUBLISH_FIRST
     tail = sent + count;
#endif
     i = 0;
     do
     :: i < count -> cells[(sent + i) % CELLS] = sent + i + 1; i++
     :: else -> break
     od;
#ifndef PUBLISH_FIRST
     tail = sent + count;
#endif
     sent = sent + count
  :: else -> break
  od
}

proctype consumer() {
  byte other, count, i, want, value;
  do
  :: received < MESSAGES ->
     if :: want = 1 :: want = BATCH fi;
     if
     :: other - received < want -> other = tail
     :: else
     fi;
     assert(other - received <= CAPACITY);
     count = other - received;
     if :: count > want -> count = want :: else fi;
#ifdef FREE_FIRST
     head = received + count;
#endif
     i = 0;
     do
     :: i < count ->
        value = cells[(received + i) % CELLS];
        assert(value == received + i + 1);   /* in order, none lost, none doubled, none half written */
        i++
     :: else -> break
     od;
#ifndef FREE_FIRST
     head = received + count;
#endif
     received = received + count
  :: else -> break
  od
}

init { atomic { run producer(); run consumer() } }

/* Whatever the schedule, as long as both sides are given their turns, everything arrives. */
ltl all_arrive { <> (received == MESSAGES) }
