/* The ring with numbered cells of ringbus/queues/mpmc_ring.h, with batches: tickets are taken by compare-and-swap after
 * the cells have been seen at their turn. Numbers: 2p free for ticket p, 2p + 1 holds what ticket p pushed.
 *
 * Faults to plant: -DNUMBER_FIRST the cell's number before its value; -DVYUKOV_NUMBERS the numbers p and p + 1 as first
 * published, which do not tell full from free at capacity 1; -DBLIND_BATCH only the last cell of a batch is looked at;
 * -DNO_SWAP the ticket is read and written in two steps. */
#ifndef CAPACITY
#define CAPACITY 2
#endif
#ifndef PRODUCERS
#define PRODUCERS 2
#endif
#ifndef CONSUMERS
#define CONSUMERS 2
#endif
#ifndef EACH
#define EACH 2       /* messages of a producer */
#endif
#ifndef BATCH
#define BATCH 1
#endif
#define ALL (PRODUCERS * EACH)

#ifdef VYUKOV_NUMBERS
#define FREE(p) (p)
#define FULL(p) ((p) + 1)
#else
#define FREE(p) (2 * (p))
#define FULL(p) (2 * (p) + 1)
#endif

byte number[CAPACITY], value[CAPACITY];
byte tail, head;
byte taken[PRODUCERS * EACH];   /* how often each message was popped */
byte popped;

proctype producer(byte p) {
  byte sent, first, count, want, i;
  do
  :: sent < EACH ->
     if :: want = 1 :: want = BATCH fi;
     if :: want > EACH - sent -> want = EACH - sent :: else fi;
     if :: want > CAPACITY -> want = CAPACITY :: else fi;
     first = tail;
     count = 0;
#ifdef BLIND_BATCH
     if
     :: number[(first + want - 1) % CAPACITY] == FREE(first + want - 1) -> count = want
     :: else
     fi;
#else
     do
     :: count < want && number[(first + count) % CAPACITY] == FREE(first + count) -> count++
     :: else -> break
     od;
#endif
     if
     :: count > 0 ->
#ifdef NO_SWAP
        tail = first + count;
#else
        atomic {
          if
          :: tail == first -> tail = first + count
          :: else -> count = 0
          fi
        }
#endif
     :: else   /* full, or another was quicker: try again */
     fi;
     i = 0;
     do
     :: i < count ->
        assert(number[(first + i) % CAPACITY] == FREE(first + i));   /* ours alone */
#ifdef NUMBER_FIRST
        number[(first + i) % CAPACITY] = FULL(first + i);
        value[(first + i) % CAPACITY] = p * EACH + sent + i + 1;
#else
        value[(first + i) % CAPACITY] = p * EACH + sent + i + 1;
        number[(first + i) % CAPACITY] = FULL(first + i);
#endif
        i++
     :: else -> break
     od;
     sent = sent + count
  :: else -> break
  od
}

proctype consumer() {
  byte first, count, want, i, message, which;
  byte last[PRODUCERS];   /* latest message of each producer, plus one */
  do
  :: popped < ALL ->
     if :: want = 1 :: want = BATCH fi;
     if :: want > CAPACITY -> want = CAPACITY :: else fi;
     first = head;
     count = 0;
     do
     :: count < want && number[(first + count) % CAPACITY] == FULL(first + count) -> count++
     :: else -> break
     od;
     if
     :: count > 0 ->
        atomic {
          if
          :: head == first -> head = first + count
          :: else -> count = 0
          fi
        }
     :: else
     fi;
     i = 0;
     do
     :: i < count ->
        message = value[(first + i) % CAPACITY];
        assert(message > 0);
        message--;
        d_step {
          taken[message]++;
          assert(taken[message] == 1);                 /* once */
          which = message / EACH;
          assert(message % EACH >= last[which]);       /* in its producer's order */
          last[which] = message % EACH + 1
        }
        assert(number[(first + i) % CAPACITY] == FULL(first + i));
        value[(first + i) % CAPACITY] = 0;
        number[(first + i) % CAPACITY] = FREE(first + i + CAPACITY);
        atomic { popped++; i++ }
     :: else -> break
     od
  :: else -> break
  od
}

init {
  byte k;
  atomic {
    k = 0;
    do :: k < CAPACITY -> number[k] = FREE(k); k++ :: else -> break od;
    k = 0;
    do :: k < PRODUCERS -> run producer(k); k++ :: else -> break od;
    k = 0;
    do :: k < CONSUMERS -> run consumer(); k++ :: else -> break od
  }
}

ltl all_arrive { <> (popped == ALL) }
