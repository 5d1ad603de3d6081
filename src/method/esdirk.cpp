// The library's instance of the bodies in <pliant/method/esdirk-inl.h>.
#include <pliant/method/esdirk-inl.h>
