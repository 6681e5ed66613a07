/* A goal that changes no faster than a limit. */
#define SLOWS
