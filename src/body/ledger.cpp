// The compiled function bodies of ledger-inl.h.
#include <pliant/body/ledger-inl.h>
