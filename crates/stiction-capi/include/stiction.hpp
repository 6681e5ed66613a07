/* C++ interface of stiction, C++11: handles that free themselves, and exceptions. See docs/c-api.md. */
#ifndef STICTION_HPP
#define STICTION_HPP

#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stiction.h"

namespace stiction {

/// A call that was refused: what() is the sentence of the library.
class error : public std::runtime_error {
public:
    explicit error(stiction_status status)
        : std::runtime_error(stiction_message()), status_(status) {}
    stiction_status status() const noexcept { return status_; }

private:
    stiction_status status_;
};

using numbers = std::map<std::string, double>;
using words = std::map<std::string, std::string>;

namespace detail {

inline void check(stiction_status status) {
    if (status != STICTION_STATUS_OK) {
        throw error(status);
    }
}

/// Names and values as the C interface takes them.
struct stated {
    std::vector<const char *> names;
    std::vector<double> values;
    explicit stated(const numbers &given) {
        for (const auto &each : given) {
            names.push_back(each.first.c_str());
            values.push_back(each.second);
        }
    }
};

template <typename Handle, stiction_status (*length)(Handle *, std::size_t *),
          stiction_status (*copy)(Handle *, double *, std::size_t)>
std::vector<double> state_of(Handle *handle) {
    std::size_t number = 0;
    check(length(handle, &number));
    std::vector<double> values(number);
    check(copy(handle, values.data(), number));
    return values;
}

} // namespace detail

/// A friction law with its state, and with the effects that act at the contact.
class friction {
public:
    explicit friction(const std::string &law, const numbers &parameters = {},
                      const words &options = {}) {
        const detail::stated given(parameters);
        std::vector<const char *> names, choices;
        for (const auto &each : options) {
            names.push_back(each.first.c_str());
            choices.push_back(each.second.c_str());
        }
        stiction_friction *made = nullptr;
        detail::check(stiction_friction_new(law.c_str(), given.names.data(), given.values.data(),
                                            given.values.size(), names.data(), choices.data(),
                                            names.size(), &made));
        handle_.reset(made);
    }

    void add_effect(const std::string &effect, const numbers &parameters = {}) {
        const detail::stated given(parameters);
        detail::check(stiction_friction_add_effect(get(), effect.c_str(), given.names.data(),
                                                   given.values.data(), given.values.size()));
    }

    /// Friction at the end of a sample of held velocity.
    double step(double velocity, double dt, double effort = 0.0, double load = 0.0) {
        double force = 0.0;
        detail::check(stiction_friction_step(get(), velocity, dt, effort, load, &force));
        return force;
    }

    struct trial_result {
        double force, slope;
    };
    /// The same and its slope by the velocity, with the state left as it is until commit().
    trial_result trial(double velocity, double dt, double effort = 0.0, double load = 0.0) {
        trial_result found = {};
        detail::check(stiction_friction_trial(get(), velocity, dt, effort, load, &found.force,
                                              &found.slope));
        return found;
    }
    void commit() { detail::check(stiction_friction_commit(get())); }
    void reset() { detail::check(stiction_friction_reset(get())); }
    void set_temperature(double celsius) {
        detail::check(stiction_friction_set_temperature(get(), celsius));
    }
    double number(const std::string &name) const {
        double value = 0.0;
        detail::check(stiction_friction_get_number(get(), name.c_str(), &value));
        return value;
    }
    std::vector<double> state() const {
        return detail::state_of<stiction_friction, stiction_friction_state_length,
                                stiction_friction_get_state>(get());
    }
    void set_state(const std::vector<double> &values) {
        detail::check(stiction_friction_set_state(get(), values.data(), values.size()));
    }
    stiction_friction *get() const noexcept { return handle_.get(); }

private:
    struct freed {
        void operator()(stiction_friction *handle) const { stiction_friction_free(handle); }
    };
    std::unique_ptr<stiction_friction, freed> handle_;
};

/// A body with inertia, driven by an input and resisted by friction.
class motor {
public:
    motor(double inertia, double gain, const friction &contact) {
        stiction_motor *made = nullptr;
        detail::check(stiction_motor_new(inertia, gain, contact.get(), &made));
        handle_.reset(made);
    }
    /// Of the text of a plant file.
    static motor from_plant(const std::string &text) {
        stiction_motor *made = nullptr;
        detail::check(stiction_motor_from_plant(text.c_str(), &made));
        return motor(made);
    }
    /// Of a plant file.
    static motor load_plant(const std::string &path) {
        stiction_motor *made = nullptr;
        detail::check(stiction_motor_load_plant(path.c_str(), &made));
        return motor(made);
    }

    struct place {
        double position, velocity;
    };
    /// Where a sample with input and load held leads.
    place step(double input, double dt, double load = 0.0) {
        place found = {};
        detail::check(
            stiction_motor_step(get(), input, load, dt, &found.position, &found.velocity));
        return found;
    }
    void reset(double position = 0.0, double velocity = 0.0) {
        detail::check(stiction_motor_reset(get(), position, velocity));
    }
    void set_temperature(double celsius) {
        detail::check(stiction_motor_set_temperature(get(), celsius));
    }
    void set_enabled(bool enabled) {
        detail::check(stiction_motor_set_enabled(get(), enabled ? 1 : 0));
    }
    /// What the position sensor reads.
    double measured() const {
        double reading = 0.0;
        detail::check(stiction_motor_measured(get(), &reading));
        return reading;
    }
    double number(const std::string &name) const {
        double value = 0.0;
        detail::check(stiction_motor_get_number(get(), name.c_str(), &value));
        return value;
    }
    std::vector<double> state() const {
        return detail::state_of<stiction_motor, stiction_motor_state_length,
                                stiction_motor_get_state>(get());
    }
    void set_state(const std::vector<double> &values) {
        detail::check(stiction_motor_set_state(get(), values.data(), values.size()));
    }
    stiction_motor *get() const noexcept { return handle_.get(); }

private:
    explicit motor(stiction_motor *made) : handle_(made) {}
    struct freed {
        void operator()(stiction_motor *handle) const { stiction_motor_free(handle); }
    };
    std::unique_ptr<stiction_motor, freed> handle_;
};

inline std::string version() { return stiction_version(); }

} // namespace stiction

#endif
