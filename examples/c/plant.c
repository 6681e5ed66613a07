/* Steps the machine of a plant file for a second; see docs/c-api.md.
 *
 *     cc plant.c $(pkg-config --cflags --libs stiction) -o plant && ./plant plant.toml
 */
#include <stdio.h>

#include "stiction.h"

int main(int count, char **words)
{
    stiction_motor *motor = NULL;
    double position = 0.0, velocity = 0.0;
    int k;
    if (count != 2 || stiction_motor_load_plant(words[1], &motor) != STICTION_STATUS_OK) {
        fprintf(stderr, "%s\n", count == 2 ? stiction_message() : "usage: plant plant.toml");
        return 2;
    }
    for (k = 0; k < 1000; ++k) {
        if (stiction_motor_step(motor, 0.5, 0.0, 1e-3, &position, &velocity)
            != STICTION_STATUS_OK) {
            fprintf(stderr, "%s\n", stiction_message());
            break;
        }
    }
    printf("%.12g\n", position);
    stiction_motor_free(motor);
    return k < 1000;
}
