// Numbers and text for people: no exponents, no more digits than mean something.
#pragma once

#include <string>

namespace sinew::study {

/// Two significant digits below ten, whole numbers up to a thousand, three significant digits beyond: "0.28",
/// "15", "1,230". Never an exponent. "–" for what is negative or no number.
std::string number(double value);
/// "0.28 µs", "1000 µs"; from 2 ms on in milliseconds.
std::string duration(double microseconds);
/// "1 cm", "6.7 mm", "0.1 µm": two significant digits.
std::string length(double metres);
/// The rate of steps of h seconds: "60 Hz".
std::string rate(double h);
/// For HTML and XML, in and between tags.
std::string escaped(const std::string& text);

}  // namespace sinew::study
