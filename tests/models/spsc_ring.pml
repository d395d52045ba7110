/* The single-producer single-consumer ring of ringbus/queues/spsc_ring.h: the first cell of what a push publishes holds
 * the producer's index after it.
 *
 * Spin's processes see every write at once, in program order: sequential consistency. A release that pairs with an
 * acquire gives the same guarantee for what stands before and after it, which is all the ring uses; what a missing
 * release would allow (a run's end seen before its cells) is the fault PUBLISH_FIRST. Indices count on.
 *
 * Faults to plant: -DPUBLISH_FIRST a run's end before its cells; -DFREE_FIRST the cells given back before they are read;
 * -DONE_TOO_MANY takes capacity + 1; -DSTALE_END what a cell holds from a lap before is taken for a run. */
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

byte value_of[CELLS];
byte run_end[CELLS];       /* of the run that began in the cell when it was last written as a first one */
byte taken;                /* the consumer's index, for the producer to see */
byte received;             /* what the consumer has checked */

proctype producer() {
  byte sent, other, count, i, want;
  do
  :: sent < MESSAGES ->
     if :: want = 1 :: want = BATCH fi;
     if :: want > MESSAGES - sent -> want = MESSAGES - sent :: else fi;
     /* the cached index, refreshed when it does not promise enough room */
     if
     :: ROOM - (sent - other) < want -> other = taken
     :: else
     fi;
     count = ROOM - (sent - other);
     if :: count > want -> count = want :: else fi;
     if
     :: count > 0 ->
#ifdef PUBLISH_FIRST
        run_end[sent % CELLS] = sent + count;
#endif
        i = 0;
        do
        :: i < count -> value_of[(sent + i) % CELLS] = sent + i + 1; i++
        :: else -> break
        od;
#ifndef PUBLISH_FIRST
        run_end[sent % CELLS] = sent + count;
#endif
        sent = sent + count
     :: else
     fi
  :: else -> break
  od
}

proctype consumer() {
  byte head, other, count, want, value, end;
  do
  :: received < MESSAGES ->
     if :: want = 1 :: want = BATCH fi;
     count = 0;
     do
     :: count < want ->
        if
        :: head == other ->
           end = run_end[head % CELLS];
#ifdef STALE_END
           if :: end != head && end > 0 -> other = end :: else -> break fi
#else
           if :: end > head -> other = end :: else -> break fi
#endif
        :: else
        fi;
        assert(other - head <= CAPACITY);
#ifdef FREE_FIRST
        taken = head + 1;
#endif
        value = value_of[head % CELLS];
        assert(value == head + 1);   /* in order, none lost, none doubled, none half written */
        head++; count++
     :: else -> break
     od;
#ifndef FREE_FIRST
     taken = head;
#endif
     received = head
  :: else -> break
  od
}

init { atomic { run producer(); run consumer() } }

/* Whatever the schedule, as long as both sides are given their turns, everything arrives. */
ltl all_arrive { <> (received == MESSAGES) }
