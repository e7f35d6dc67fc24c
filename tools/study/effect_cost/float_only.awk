# Leaves the instances for double out of a source of the runtime: statements "template …;" that name no <float>,
# and lists of instances by macro.
/^template [^<]/ { held = ""; inside = 1 }
inside {
  held = held $0 "\n"
  if (/;$/) {
    if (held ~ /<float>/) printf "%s", held
    inside = 0
  }
  next
}
/^SINEW_[A-Z_]*\((template, )?double\)/ { next }
{ print }
