/* An input that arrives late. */
#define DELAYS
