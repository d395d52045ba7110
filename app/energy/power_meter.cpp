#include "app/energy/power_meter.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "report/text/ratio.h"

namespace carousel::app {

namespace {

constexpr std::size_t kSlots = PowerMeter::kWindow / PowerMeter::kResolution;  // in a window

/// The names of the parts, as in energy.parts.
std::vector<std::string> part_names() {
  std::vector<std::string> out;
  report::EnergyParts{}.for_each([&](const char* key, const report::EnergyOf&) { out.emplace_back(key); });
  return out;
}

template <class Joules>
double sum(const Joules& joules) {
  return std::accumulate(joules.begin(), joules.end(), 0.0);
}

template <class Joules>
Joules difference(const Joules& later, const Joules& earlier) {
  Joules out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = later[i] - earlier[i];
  return out;
}

}  // namespace

void PowerMeter::begin(const std::vector<ByteRow>& rows, std::size_t most_samples) {
  account_.emplace(config_, link_mm_, rows);
  most_ = 2 * most_samples;
  if (most_ == 0) next_sample_ = std::numeric_limits<std::uint64_t>::max();
}

PowerMeter::Joules PowerMeter::joules(const ringbus::EnergyEvents& events) const {
  Joules out{};
  std::size_t i = 0;
  account_->parts(events).for_each([&](const char*, const report::EnergyOf& part) { out[i++] = part.joules; });
  return out;
}

void PowerMeter::read(const ringbus::EnergyEvents& events) {
  const std::uint64_t at = next();
  const Joules now = joules(events);
  if (at == next_sample_) {
    readings_.push_back(now);
    if (readings_.size() == most_) halve();
    next_sample_ = interval_ * (readings_.size() + 1);
  }
  if (at == next_slot_) end_slot(now);
}

void PowerMeter::halve() {
  for (std::size_t i = 0; i < readings_.size() / 2; ++i) readings_[i] = readings_[2 * i + 1];
  readings_.resize(readings_.size() / 2);
  interval_ *= 2;
}

/// Windows of kWindow cycles end with each slot, and any other one lies within a window and the slot before it.
void PowerMeter::end_slot(const Joules& now) {
  slots_.push_back(now);
  if (slots_.size() > kSlots + 2) slots_.pop_front();
  if (slots_.size() > kSlots) {
    const Joules window = difference(now, slots_[slots_.size() - 1 - kSlots]);
    if (const double all = sum(window); all > peak_.joules) peak_ = {all, next_slot_ - kWindow, window};
    most_around_ = std::max(most_around_, sum(difference(now, slots_.front())));
  }
  next_slot_ += kResolution;
}

/// The last slot is read as if it ended with the run, so that no window of the run is left out.
void PowerMeter::close(std::uint64_t cycles, const ringbus::EnergyEvents& events) {
  last_ = joules(events);
  while (next_slot_ <= cycles) end_slot(last_);
  if (slots_.size() > kSlots)
    most_around_ = std::max(most_around_, sum(difference(last_, slots_[slots_.size() - 1 - kSlots])));
}

void PowerMeter::add_rows(ringbus::TimeSeries& series) const {
  const std::vector<std::string> names = part_names();
  const std::size_t step = static_cast<std::size_t>(series.interval) / interval_;
  for (std::size_t part = 0; part < names.size(); ++part) {
    std::string quantity = "energy of " + names[part];
    std::replace(quantity.begin(), quantity.end(), '_', ' ');
    ringbus::SeriesRow row{"machine", std::move(quantity), "J", ringbus::SeriesRow::Kind::kSum};
    double before = 0;
    for (std::size_t i = 0; i < series.samples; ++i) {
      const std::size_t reading = (i + 1) * step - 1;
      const double at = reading < readings_.size() && i + 1 < series.samples ? readings_[reading][part] : last_[part];
      row.values.push_back(at - std::exchange(before, at));
    }
    series.add(std::move(row));
  }
}

std::optional<report::PowerPeak> PowerMeter::peak() const {
  if (peak_.joules < 0) return std::nullopt;
  const double seconds = static_cast<double>(kWindow) / (static_cast<double>(clock_mhz_) * 1e6);
  const auto most = std::max_element(peak_.parts.begin(), peak_.parts.end());
  report::PowerPeak out;
  out.first_cycle = peak_.first_cycle;
  out.cycles = kWindow;
  out.resolution = kResolution;
  out.watts = peak_.joules / seconds;
  out.watts_at_most = most_around_ / seconds;
  out.part = part_names()[static_cast<std::size_t>(most - peak_.parts.begin())];
  out.part_share = report::ratio(*most, peak_.joules);
  return out;
}

}  // namespace carousel::app
