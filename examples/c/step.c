/* A friction model and a motor from C, stepped side by side; prints the bits of what comes out.
 *   cargo build --release -p stiction-capi
 *   cc examples/c/step.c -I crates/stiction-capi/include target/release/libstiction_capi.a \
 *      -lm -lpthread -ldl -o step && ./step */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stiction.h"

static void done(enum stiction_status status) {
    if (status != STICTION_STATUS_OK) {
        fprintf(stderr, "%s\n", stiction_message());
        exit(EXIT_FAILURE);
    }
}

static void show(const char *name, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    printf("%s %.9g %016" PRIx64 "\n", name, value, bits);
}

int main(void) {
    const char *names[] = {"breakaway", "viscous"};
    const double values[] = {0.5, 0.05};
    struct stiction_friction *friction = NULL;
    struct stiction_motor *motor = NULL;
    done(stiction_friction_new("hsieh_pan", names, values, 2, NULL, NULL, 0, &friction));
    done(stiction_motor_new(0.0076, 1.0, friction, &motor));

    for (int k = 0; k < 2000; k++) {
        double force, position, velocity;
        done(stiction_friction_step(friction, k < 1000 ? 1e-3 : -1e-3, 1e-3, 0.0, 0.0, &force));
        double input = k % 200 < 100 ? 0.6 : -0.1;
        done(stiction_motor_step(motor, input, 0.0, 1e-3, &position, &velocity));
        if (k % 100 == 99) {
            show("force", force);
            show("position", position);
            show("velocity", velocity);
        }
    }

    /* A name that no law has is refused, with a sentence. */
    struct stiction_friction *none = NULL;
    const char *wrong[] = {"coulombs"};
    if (stiction_friction_new("coulomb", wrong, values, 1, NULL, NULL, 0, &none)
        == STICTION_STATUS_REFUSED) {
        fprintf(stderr, "%s\n", stiction_message());
        printf("refused: coulombs\n");
    }
    stiction_motor_free(motor);
    stiction_friction_free(friction);
    return EXIT_SUCCESS;
}
