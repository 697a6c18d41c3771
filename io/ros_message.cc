// Messages as ROS 1 serializes them, field after field, and as CDR of ROS 2: each number at a multiple of its size.
#include <algorithm>
#include <bit>
#include <cstring>
#include "io/ros.h"

namespace scancal {
namespace {

class Fields {
 public:
  explicit Fields(const RosMessage& message) : rest_(message.data), cdr_(message.cdr) {
    if (!cdr_) return;
    // Two bytes of the representation, CDR in big or little endian, and two of options.
    ok_ = rest_.size() >= 4 && rest_[0] == 0 && (rest_[1] == 0 || rest_[1] == 1);
    swapped_ = ok_ && rest_[1] == 0;
    if (ok_) rest_.remove_prefix(4);
    size_ = rest_.size();
  }
  bool ok() const { return ok_; }

  template <class Number>
  Number Take() {
    if (cdr_) Drop((sizeof(Number) - (size_ - rest_.size()) % sizeof(Number)) % sizeof(Number));
    char bytes[sizeof(Number)] = {};
    if (rest_.size() < sizeof(Number)) ok_ = false;
    if (!ok_) return 0;
    std::memcpy(bytes, rest_.data(), sizeof(Number));
    rest_.remove_prefix(sizeof(Number));
    if (swapped_) std::reverse(std::begin(bytes), std::end(bytes));
    return std::bit_cast<Number>(bytes);
  }

  std::string_view Text() {
    const size_t size = Take<uint32_t>();
    const std::string_view text = rest_.substr(0, size);
    Drop(size);
    return ok_ && cdr_ && text.ends_with('\0') ? text.substr(0, size - 1) : text;
  }

  // Of a list whose elements take at least so many bytes.
  size_t Count(size_t element) {
    const size_t count = Take<uint32_t>();
    ok_ &= count <= rest_.size() / element;
    return ok_ ? count : 0;
  }

  int64_t Header() {
    if (!cdr_) Take<uint32_t>();  // seq
    const int64_t seconds = Take<uint32_t>(), nanoseconds = Take<uint32_t>();
    Text();  // frame_id
    return seconds * 1'000'000'000 + nanoseconds;
  }

 private:
  void Drop(size_t size) {
    ok_ &= size <= rest_.size();
    rest_.remove_prefix(std::min(size, rest_.size()));
  }

  std::string_view rest_;
  bool cdr_, swapped_ = false, ok_ = true;
  size_t size_ = 0;
};

}  // namespace

bool Decode(const RosMessage& message, LaserScan* scan) {
  Fields fields(message);
  scan->stamp_ns = fields.Header();
  scan->angle_min = fields.Take<float>();
  fields.Take<float>();  // angle_max
  scan->angle_increment = fields.Take<float>();
  scan->time_increment = fields.Take<float>();
  fields.Take<float>();  // scan_time
  scan->range_min = fields.Take<float>();
  scan->range_max = fields.Take<float>();
  scan->ranges.resize(fields.Count(sizeof(float)));
  for (float& range : scan->ranges) range = fields.Take<float>();
  return fields.ok();
}

bool Decode(const RosMessage& message, JointState* state) {
  Fields fields(message);
  state->stamp_ns = fields.Header();
  state->names.resize(fields.Count(sizeof(uint32_t)));
  for (std::string& name : state->names) name = fields.Text();
  state->positions.resize(std::min(fields.Count(sizeof(double)), state->names.size()));
  for (double& position : state->positions) position = fields.Take<double>();
  return fields.ok();
}

}  // namespace scancal
