"""Several chains that carry one platform: their loops closed, their rates and accelerations."""
