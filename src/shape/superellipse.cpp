// The library compiles the bodies of this header here.
#include <pliant/shape/superellipse-inl.h>
