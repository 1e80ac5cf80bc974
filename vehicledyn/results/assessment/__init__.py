"""Running safety, ride comfort and wear of a rail vehicle, from the channels of a run."""
