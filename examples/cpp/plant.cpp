/* Steps the machine of a plant file for a second; see docs/c-api.md.
 *
 *     c++ plant.cpp $(pkg-config --cflags --libs stiction) -o plant && ./plant plant.toml
 */
#include <cstdio>
#include <exception>

#include "stiction.hpp"

int main(int count, char **words)
{
    if (count != 2) {
        std::fprintf(stderr, "usage: plant plant.toml\n");
        return 2;
    }
    try {
        auto motor = stiction::motor::load_plant(words[1]);
        stiction::motor::place place = {};
        for (int k = 0; k < 1000; ++k) {
            place = motor.step(0.5, 1e-3);
        }
        std::printf("%.12g\n", place.position);
    } catch (const std::exception &refused) {
        std::fprintf(stderr, "%s\n", refused.what());
        return 2;
    }
}
