// Prints what the C library says of angles, bit for bit: its functions have variants by processor,
// and this shows which one a process has got.
#include <cmath>
#include <cstdio>
#include <numbers>

int main() {
  for (int tenths = -1800; tenths <= 1800; ++tenths) {
    const double angle = tenths / 10.0 * std::numbers::pi / 180;
    const double sine = std::sin(angle);
    const double cosine = std::cos(angle);
    std::printf("%.1f %a %a %a\n", tenths / 10.0, sine, cosine, std::atan2(sine, cosine));
  }
}
